// A segmentation from memory to memory.
#include "pellicle/job/segment.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "pellicle/base/errors.h"
#include "pellicle/job/seeds.h"
#include "pellicle/mask/overlap.h"
#include "pellicle/synthetic/cluster.h"

namespace pellicle {
namespace {

Phantom bean(const Vec3& direction_degrees = {0, 0, 0}) {
  return make_phantom(
      {.shape = "bean", .size = {48, 48, 44}, .direction_degrees = direction_degrees, .radius = {12.0}});
}

double dice_of(const Image<std::uint8_t>& truth, const Image<std::uint16_t>& labels) {
  Image<std::uint8_t> mask(labels.grid);
  std::transform(labels.voxels.begin(), labels.voxels.end(), mask.voxels.begin(),
                 [](std::uint16_t label) { return static_cast<std::uint8_t>(label != 0 ? 1 : 0); });
  return overlap_of(truth, mask).dice;
}

TEST(Segment, OneObjectWithItsMaps) {
  const Phantom phantom = bean();
  SegmentOptions options{.fraction_map = true, .distance_map = true};
  const Segmentation found = segment(
      phantom.image, {{.label = 7, .name = "bean", .candidates = {SeedSphere{phantom.natural_center, 6.0}}}}, options);
  ASSERT_EQ(found.objects.size(), 1U);
  const ObjectResult& object = found.objects.front();
  EXPECT_TRUE(found.all_ok()) << object.fit.reason;
  EXPECT_GT(dice_of(phantom.truth, found.labels), 0.95);
  EXPECT_NEAR(object.volume_surface_ml, phantom.exact_volume_ml, 0.05 * phantom.exact_volume_ml);
  EXPECT_NEAR(object.volume_partial_ml, object.volume_surface_ml, 0.01 * object.volume_surface_ml);
  EXPECT_TRUE(found.image.voxels.empty());
  for (std::size_t i = 0; i < found.labels.voxels.size(); ++i) {
    EXPECT_TRUE(found.labels.voxels[i] == 0 || found.labels.voxels[i] == 7);
    if (std::abs(found.distance.voxels[i]) > 1.0F) {
      EXPECT_EQ(found.distance.voxels[i] < 0.0F, found.labels.voxels[i] == 7);
      EXPECT_EQ(found.fraction.voxels[i], found.labels.voxels[i] == 7 ? 1.0F : 0.0F);
    }
  }
}

TEST(Segment, WithoutASeedTheObjectIsFoundOnAnyGrid) {
  const Phantom phantom = bean({0, 0, 100});
  const Segmentation found = segment(phantom.image, {});
  ASSERT_EQ(found.objects.size(), 1U);
  EXPECT_EQ(found.labels.grid.direction, phantom.image.grid.direction);
  EXPECT_GT(dice_of(phantom.truth, found.labels), 0.9);
}

TEST(Segment, TheHostHearsOfProgressAndStopsTheRun) {
  const Phantom phantom = bean();
  const std::vector<ObjectSeed> seeds{{.candidates = {SeedSphere{phantom.natural_center, 6.0}}}};
  std::vector<double> fractions;
  segment(phantom.image, seeds, {},
          {.progress = [&](double fraction, const std::string&) { fractions.push_back(fraction); }});
  ASSERT_FALSE(fractions.empty());
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_GE(fractions.front(), 0.0);
  EXPECT_LE(fractions.back(), 1.0);
  EXPECT_THROW(segment(phantom.image, seeds, {}, {.stopped = [] { return true; }}), Interrupted);
}

TEST(Segment, AConstantImageHasOneAnswerForOneObjectAndAnotherForMany) {
  ImageGrid grid;
  grid.size = {12, 12, 12};
  const Image<float> image(grid, 3.0F);
  EXPECT_THROW(segment(image, {}), BadData);
  const Segmentation none = segment(image, {}, {.many = true});
  EXPECT_TRUE(none.objects.empty());
  EXPECT_EQ(none.warnings.size(), 1U);
}

TEST(Segment, ManyObjectsGetALabelEach) {
  const Cluster cluster = make_cluster({.image = {.size = {64, 64, 48}, .snr = 10.0}, .count = 6, .distance = 1.2});
  SegmentOptions options{.many = true};
  options.fit.model.kind = ModelKind::catmull_clark;
  const Segmentation found = segment(cluster.image, {}, options);
  EXPECT_EQ(found.objects.size(), 6U);
  ASSERT_TRUE(found.many);
  for (const ObjectResult& object : found.objects) {
    const auto count = std::count(found.labels.voxels.begin(), found.labels.voxels.end(), object.label);
    EXPECT_NEAR(static_cast<double>(count) * found.labels.grid.voxel_volume() / 1000.0, object.volume_mask_ml, 1e-9);
    EXPECT_TRUE(object.shape);
  }
}

TEST(SegmentSeries, AFrameStartsFromTheLastSurface) {
  const Phantom phantom = bean();
  SegmentSeries series;
  EXPECT_TRUE(series.carried_seeds().empty());
  const std::vector<ObjectSeed> seeds{{.label = 3, .candidates = {SeedSphere{phantom.natural_center, 6.0}}}};
  const Segmentation first = series.next(phantom.image, seeds, {});
  const std::vector<ObjectSeed> carried = series.carried_seeds();
  ASSERT_EQ(carried.size(), 1U);
  EXPECT_EQ(carried.front().label, 3);
  EXPECT_EQ(std::get<Surface>(carried.front().candidates.front()).parameters, first.objects.front().surface.parameters);
  const Segmentation second = series.next(phantom.image, carried, {});
  EXPECT_GT(dice_of(phantom.truth, second.labels), 0.95);
}

TEST(Seeds, LabelsMustDiffer) {
  EXPECT_EQ(numbered({{.label = 4}}).front().name, "object-4");
  EXPECT_THROW(numbered({{.label = 4}, {.label = 4}}), UsageError);
}

}  // namespace
}  // namespace pellicle
