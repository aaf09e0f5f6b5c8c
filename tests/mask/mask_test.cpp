// Connected parts, the largest of them, moments, morphology, overlap.

#include <gtest/gtest.h>

#include <algorithm>

#include "pellicle/base/errors.h"
#include "pellicle/mask/components.h"
#include "pellicle/mask/moments.h"
#include "pellicle/mask/morphology.h"
#include "pellicle/mask/overlap.h"
#include "pellicle/mask/parts.h"
#include "pellicle/synthetic/phantom.h"

namespace pellicle {
namespace {

Image<std::uint8_t> empty_mask(const Index3& size, const Vec3& spacing = Vec3::Ones()) {
  ImageGrid grid;
  grid.size = size;
  grid.spacing = spacing;
  grid.origin_in_world = Vec3(10, -20, 30);
  return Image<std::uint8_t>(grid);
}

void fill_box(Image<std::uint8_t>& mask, const Index3& begin, const Index3& size) {
  for (int k = begin[2]; k < begin[2] + size[2]; ++k) {
    for (int j = begin[1]; j < begin[1] + size[1]; ++j) {
      for (int i = begin[0]; i < begin[0] + size[0]; ++i) mask.at(i, j, k) = 1;
    }
  }
}

TEST(Components, are_counted_ordered_and_labelled) {
  Image<std::uint8_t> mask = empty_mask({30, 20, 20});
  fill_box(mask, {2, 2, 2}, {3, 3, 3});
  fill_box(mask, {10, 5, 5}, {7, 7, 7});
  fill_box(mask, {20, 15, 15}, {5, 2, 2});
  const Components c = components_of(mask);
  ASSERT_EQ(c.parts.size(), 3U);
  EXPECT_EQ(c.parts[0].voxels, 343U);
  EXPECT_EQ(c.parts[1].voxels, 27U);
  EXPECT_EQ(c.parts[2].voxels, 20U);
  std::vector<std::size_t> count(4, 0);
  for (std::size_t i = 0; i < mask.voxels.size(); ++i) {
    const int label = c.labels.voxels[i];
    ASSERT_TRUE(label >= 0 && label <= 3);
    EXPECT_EQ(label != 0, mask.voxels[i] != 0);
    ++count[static_cast<std::size_t>(label)];
  }
  for (std::size_t part = 0; part < 3; ++part) {
    EXPECT_EQ(c.parts[part].id, static_cast<int>(part) + 1);
    EXPECT_EQ(count[part + 1], c.parts[part].voxels);
  }
}

TEST(Components, hold_together_by_faces_alone) {
  Image<std::uint8_t> mask = empty_mask({4, 4, 4});
  mask.at(0, 0, 0) = mask.at(1, 1, 0) = mask.at(2, 2, 1) = 1;
  EXPECT_EQ(components_of(mask).parts.size(), 3U);
  mask.at(1, 0, 0) = mask.at(2, 1, 0) = mask.at(2, 2, 0) = 1;
  EXPECT_EQ(components_of(mask).parts.size(), 1U);
}

TEST(Components, deepest_point_and_depth_of_a_cube) {
  Image<std::uint8_t> mask = empty_mask({20, 20, 20}, Vec3(2, 2, 2));
  fill_box(mask, {5, 6, 7}, {7, 7, 7});
  const Component part = components_of(mask).parts.at(0);
  EXPECT_LE((part.deepest - mask.grid.world_from_index(Vec3(8, 9, 10))).norm(), 1e-9);
  EXPECT_NEAR(part.depth, 7.0, 1e-9);  // half of seven voxels of 2 mm
}

TEST(Components, border_of_the_volume_is_a_border) {
  Image<std::uint8_t> mask = empty_mask({9, 9, 9});
  fill_box(mask, {0, 0, 0}, {9, 9, 9});
  const Component part = components_of(mask).parts.at(0);
  EXPECT_LE((part.deepest - mask.grid.world_from_index(Vec3(4, 4, 4))).norm(), 1e-9);
  EXPECT_TRUE(components_of(empty_mask({3, 3, 3})).parts.empty());
}

PhantomSettings small(const std::string& shape, std::vector<double> radius) {
  PhantomSettings s;
  s.shape = shape;
  s.radius = std::move(radius);
  s.size = {48, 48, 48};
  s.noise = PhantomNoise::none;
  return s;
}

TEST(Moments, of_an_ellipsoid_on_an_oblique_anisotropic_grid) {
  PhantomSettings s = small("ellipsoid", {15.0, 11.0, 8.0});
  s.spacing = Vec3(0.8, 1.0, 1.4);
  s.direction_degrees = Vec3(20, -30, 50);
  s.center = Vec3(1.3, -0.7, 0.4);
  const Phantom phantom = make_phantom(s);
  const Moments m = moments_of(phantom.truth);
  EXPECT_LE((m.centroid - s.center).norm(), 0.05);
  const Mat3 turn = phantom.body.world_from_shape;
  const Mat3 exact = turn * Vec3(15, 11, 8).asDiagonal() * turn.transpose();
  EXPECT_LE((m.shape - exact).norm() / exact.norm(), 0.01);
  EXPECT_NEAR(m.volume / (1000.0 * phantom.exact_volume_ml), 1.0, 0.01);
  EXPECT_LE((m.shape - m.shape.transpose()).norm(), 1e-9);
}

TEST(Moments, of_a_single_voxel_are_finite) {
  Image<std::uint8_t> mask = empty_mask({5, 5, 5}, Vec3(1, 2, 3));
  mask.at(2, 1, 3) = 1;
  const Moments m = moments_of(mask);
  EXPECT_LE((m.centroid - mask.grid.world_from_index(Vec3(2, 1, 3))).norm(), 1e-9);
  EXPECT_TRUE(m.shape.allFinite());
  EXPECT_GT(m.shape.determinant(), 0.0);
  EXPECT_NEAR(m.volume, 6.0, 1e-12);
}

std::size_t count_of(const Image<std::uint8_t>& mask) {
  return static_cast<std::size_t>(std::count_if(mask.voxels.begin(), mask.voxels.end(), [](auto v) { return v != 0; }));
}

TEST(Parts, largest_is_kept_and_of_equal_ones_the_first) {
  Image<std::uint8_t> mask = empty_mask({12, 8, 8});
  fill_box(mask, {1, 1, 1}, {2, 2, 2});
  fill_box(mask, {5, 5, 5}, {2, 2, 2});
  mask.at(8, 1, 1) = 7;  // any value but 0 is inside
  EXPECT_EQ(keep_largest_part(mask), 8U);
  EXPECT_EQ(mask.at(1, 1, 1), 1);
  EXPECT_EQ(count_of(mask), 8U);
  Image<std::uint8_t> none = empty_mask({3, 3, 3});
  EXPECT_EQ(keep_largest_part(none), 0U);
  EXPECT_THROW(largest_part(none, 1), BadData);
}

TEST(Parts, largest_has_its_box_and_a_margin_in_the_same_place) {
  Image<std::uint8_t> mask = empty_mask({12, 8, 8}, Vec3(1, 2, 3));
  fill_box(mask, {0, 3, 4}, {4, 3, 2});
  mask.at(10, 1, 1) = 1;
  const Image<std::uint8_t> part = largest_part(mask, 2);
  EXPECT_EQ(part.grid.size, (Index3{8, 7, 6}));
  EXPECT_EQ(count_of(part), 24U);
  EXPECT_EQ(part.at(2, 2, 2), 1);
  EXPECT_LE((part.grid.world_from_index(Vec3(2, 2, 2)) - mask.grid.world_from_index(Vec3(0, 3, 4))).norm(), 1e-12);
}

TEST(Morphology, grows_and_shrinks_by_corners_or_by_faces) {
  Image<std::uint8_t> mask = empty_mask({9, 9, 9});
  mask.at(4, 4, 4) = 1;
  grow(mask, 2);
  EXPECT_EQ(count_of(mask), 125U);
  EXPECT_EQ(count_of(shrunk_by_faces(mask)), 27U);
  shrink(mask, 2);
  EXPECT_EQ(count_of(mask), 1U);
  Image<std::uint8_t> full = empty_mask({5, 5, 5});
  fill_box(full, {0, 0, 0}, {5, 5, 5});
  EXPECT_EQ(count_of(shrunk_by_faces(full)), 27U);  // beyond the border is outside
  shrink(full, 1);
  EXPECT_EQ(count_of(full), 27U);
}

TEST(Morphology, cavities_are_filled_and_counted) {
  Image<std::uint8_t> mask = empty_mask({9, 9, 9});
  fill_box(mask, {1, 1, 1}, {7, 7, 7});
  mask.at(3, 3, 3) = mask.at(5, 5, 5) = mask.at(5, 5, 4) = 0;
  EXPECT_EQ(fill_cavities(mask), 3U);
  EXPECT_EQ(count_of(mask), 343U);
  EXPECT_EQ(fill_cavities(mask), 0U);
}

TEST(Overlap, CountsAndEmptyMasks) {
  ImageGrid grid;
  grid.size = {4, 1, 1};
  grid.spacing = {1, 2, 3};
  Image<std::uint8_t> truth(grid), result(grid);
  EXPECT_EQ(overlap_of(truth, result).dice, 1.0);
  EXPECT_EQ(overlap_of(truth, result).iou, 1.0);
  EXPECT_EQ(overlap_of(truth, result).volume_error, 0.0);
  result.voxels = {0, 1, 1, 1};
  EXPECT_EQ(overlap_of(truth, result).dice, 0.0);
  EXPECT_FALSE(overlap_of(truth, result).volume_error.has_value());
  truth.voxels = {1, 1, 0, 0};
  const OverlapMetrics m = overlap_of(truth, result);
  EXPECT_DOUBLE_EQ(m.dice, 2.0 / 5.0);
  EXPECT_DOUBLE_EQ(m.iou, 1.0 / 4.0);
  EXPECT_DOUBLE_EQ(m.volume_error.value_or(-9.0), 0.5);
  EXPECT_DOUBLE_EQ(m.truth_volume, 12.0);
  EXPECT_DOUBLE_EQ(m.result_volume, 18.0);
  ImageGrid other = grid;
  other.origin_in_world.x() += 0.1;
  EXPECT_THROW(overlap_of(truth, Image<std::uint8_t>(other)), BadData);
}

}  // namespace
}  // namespace pellicle
