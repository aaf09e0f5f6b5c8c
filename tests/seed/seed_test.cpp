// Automatic seeds, rays and the head, each against objects made for it.

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pellicle/base/errors.h"
#include "pellicle/image/resample.h"
#include "pellicle/seed/head.h"
#include "pellicle/seed/rays.h"
#include "pellicle/seed/seed.h"
#include "pellicle/synthetic/phantom.h"

namespace pellicle {
namespace {

PhantomSettings small(const std::string& shape, std::vector<double> radius) {
  PhantomSettings s;
  s.shape = shape;
  s.radius = std::move(radius);
  s.size = {48, 48, 48};
  s.noise = PhantomNoise::none;
  return s;
}

TEST(Candidates, one_lies_inside_the_object_bright_or_dark) {
  for (const auto& [inside, outside] : {std::pair{100.0, 20.0}, std::pair{20.0, 100.0}}) {
    for (const char* shape : {"sphere", "bean", "tube"}) {
      PhantomSettings s = small(shape, {9.0});
      s.size = {64, 64, 64};
      s.center = Vec3(12, -9, 8);
      s.inside = inside;
      s.outside = outside;
      s.noise = PhantomNoise::gaussian;
      const Phantom phantom = make_phantom(s);
      const std::vector<SeedSphere> seeds = find_candidates(phantom.image);
      EXPECT_TRUE(std::any_of(seeds.begin(), seeds.end(), [&](const SeedSphere& seed) {
        return seed.radius > 0.0 && phantom.body.level_at(seed.center).value < 0.0;
      })) << shape;
    }
  }
}

TEST(Candidates, same_every_time_and_in_any_intensity_unit) {
  PhantomSettings s = small("blob", {10.0});
  s.center = Vec3(5, 3, -4);
  Phantom phantom = make_phantom(s);
  const std::vector<SeedSphere> a = find_candidates(phantom.image), b = find_candidates(phantom.image);
  for (float& v : phantom.image.voxels) v = 7 * v + 100;
  const std::vector<SeedSphere> c = find_candidates(phantom.image);
  ASSERT_EQ(a.size(), b.size());
  ASSERT_EQ(a.size(), c.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].center, b[i].center);
    EXPECT_EQ(a[i].radius, b[i].radius);
    EXPECT_LE((a[i].center - c[i].center).norm(), 2.0);
  }
}

TEST(Candidates, constant_image_makes_no_trouble) {
  ImageGrid grid;
  grid.size = {20, 20, 20};
  for (const SeedSphere& seed : find_candidates(Image<float>(grid, 7.0F))) {
    EXPECT_TRUE(seed.center.allFinite());
    EXPECT_GT(seed.radius, 0.0);
  }
}

// Rays are read in the image smoothed by one voxel.
std::vector<RayReading> rays_of(const Phantom& phantom, const SeedSphere& seed) {
  const double h = phantom.image.grid.mean_spacing();
  return read_rays(gaussian_smooth(phantom.image, h), seed, h);
}

TEST(Rays, know_bright_from_dark) {
  for (const auto& [inside, outside] : {std::pair{100.0, 20.0}, std::pair{20.0, 100.0}}) {
    PhantomSettings s = small("sphere", {11.0});
    s.inside = inside;
    s.outside = outside;
    const std::vector<RayReading> r = rays_of(make_phantom(s), {Vec3(2, -1, 1), 6.0});
    ASSERT_EQ(r.size(), 3U);
    const bool bright = inside > outside;
    const RayReading &right = r[bright ? 0 : 1], &wrong = r[bright ? 1 : 0];
    EXPECT_GT(right.score, 2.0 * wrong.score);
    EXPECT_EQ(right.sign, bright ? 1.0 : -1.0);
    EXPECT_FALSE(right.ridge);
    EXPECT_NEAR(right.inside, inside, 8.0);
    EXPECT_NEAR(right.outside, outside, 8.0);
  }
}

TEST(Rays, know_a_membrane) {
  PhantomSettings s = small("sphere", {12.0});
  s.size = {64, 64, 64};
  s.fill = PhantomFill::shell;
  const std::vector<RayReading> r = rays_of(make_phantom(s), {Vec3(1, 1, -1), 6.0});
  ASSERT_EQ(r.size(), 3U);
  EXPECT_TRUE(r[2].ridge);
  EXPECT_GT(r[2].score, r[0].score);
  EXPECT_NEAR(r[2].median_radius, 12.0, 1.5);
  EXPECT_GT(r[2].inside, r[2].outside + 20.0);
}

TEST(Rays, outline_a_sphere_and_an_ellipsoid_from_off_centre) {
  const Phantom ball = make_phantom(small("sphere", {12.0}));
  const RayReading r = rays_of(ball, {Vec3(3, 2, -2), 5.0}).at(0);
  EXPECT_LE(r.center.norm(), 1.0);
  EXPECT_NEAR(std::cbrt(r.shape.determinant()), 12.0, 1.0);
  PhantomSettings s = small("ellipsoid", {15.0, 11.0, 8.0});
  s.spacing = Vec3(0.8, 1.0, 1.4);
  s.direction_degrees = Vec3(20, -30, 50);
  const Phantom phantom = make_phantom(s);
  const RayReading e = rays_of(phantom, {Vec3(1, 1, 1), 5.0}).at(0);
  const Mat3 turn = phantom.body.world_from_shape;
  const Mat3 exact = turn * Vec3(15, 11, 8).asDiagonal() * turn.transpose();
  EXPECT_LE((e.shape - exact).norm() / exact.norm(), 0.1);
  EXPECT_LE(e.center.norm(), 1.0);
}

TEST(Rays, score_knows_no_intensity_unit_but_scale_and_nothing_is_seen_in_a_flat_image) {
  Phantom phantom = make_phantom(small("sphere", {11.0}));
  const std::vector<RayReading> a = rays_of(phantom, {Vec3(1, 0, 0), 5.0});
  for (float& v : phantom.image.voxels) v = 7 * v + 100;
  const std::vector<RayReading> b = rays_of(phantom, {Vec3(1, 0, 0), 5.0});
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(b[i].score, 7 * a[i].score, 1e-2 * (1 + a[i].score));
  EXPECT_LE((a[0].shape - b[0].shape).norm(), 1e-2);
  std::fill(phantom.image.voxels.begin(), phantom.image.voxels.end(), 5.0F);
  for (const RayReading& r : rays_of(phantom, {Vec3(1, 0, 0), 5.0})) EXPECT_EQ(r.score, 0.0);
}

TEST(Core, level_and_spread_within_the_seed) {
  PhantomSettings s = small("sphere", {12.0});
  s.noise = PhantomNoise::gaussian;
  s.snr = 10.0;
  const Phantom phantom = make_phantom(s);
  const CoreStatistics core = core_statistics(phantom.image, {Vec3(0, 0, 0), 8.0}, 1.0);
  EXPECT_NEAR(core.median, 100.0, 1.0);
  EXPECT_NEAR(core.deviation, 8.0, 1.0);
  EXPECT_NEAR(core.voxels, 4.0 / 3.0 * std::numbers::pi * 512, 100);
  const CoreStatistics away = core_statistics(phantom.image, {Vec3(500, 0, 0), 1.0}, 1.0);
  EXPECT_TRUE(std::isfinite(away.median));
}

// Scalp (bright), skull (dark), brain: balls about the same centre in air.
Image<float> head_image(const Vec3& centre, double factor, double shift) {
  ImageGrid grid;
  grid.size = {60, 60, 60};
  grid.spacing = Vec3(4, 4, 4);
  grid.origin_in_world = Vec3(-118, -118, -118);
  Image<float> image(grid);
  RandomEngine random(3);
  for (int k = 0; k < 60; ++k) {
    for (int j = 0; j < 60; ++j) {
      for (int i = 0; i < 60; ++i) {
        const double r = (grid.world_from_index(Vec3(i, j, k)) - centre).norm();
        const double value = r < 70 ? 100 : r < 76 ? 30 : r < 86 ? 130 : 2;
        image.at(i, j, k) = static_cast<float>(factor * (value + random.normal()) + shift);
      }
    }
  }
  return image;
}

TEST(Head, centre_radius_and_levels_of_a_synthetic_head) {
  const Vec3 centre(6, -10, 12);
  for (const auto& [factor, shift] : {std::pair{1.0, 0.0}, std::pair{7.0, 100.0}}) {
    const HeadReading head = read_head(head_image(centre, factor, shift));
    EXPECT_LE((head.center - centre).norm(), 3.0);
    EXPECT_NEAR(head.head_radius, 86.0, 4.0);
    EXPECT_NEAR(head.levels.low, factor * 2 + shift, factor * 4);
    EXPECT_NEAR(head.levels.middle, factor * 100 + shift, factor * 5);
    EXPECT_GT(head.levels.threshold, head.levels.low);
    EXPECT_LT(head.levels.threshold, factor * 30 + shift);
    const SeedSphere seed = find_head(head_image(centre, factor, shift));
    EXPECT_EQ(seed.center, head.center);
    EXPECT_NEAR(seed.radius, 0.5 * head.head_radius, 1e-9);
  }
}

TEST(Head, image_without_contrast_is_refused_with_advice) {
  ImageGrid grid;
  grid.size = {10, 10, 10};
  try {
    find_head(Image<float>(grid, 3.0F));
    FAIL() << "no exception";
  } catch (const BadData& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("contrast"));
    EXPECT_THAT(e.what(), testing::HasSubstr("seed"));
  }
}

}  // namespace
}  // namespace pellicle
