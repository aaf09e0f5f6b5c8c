// Solids around points and out of masks: closed, of genus 0, about the right size.
#include "pellicle/raster/closed_solid.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <numbers>

#include "pellicle/base/errors.h"
#include "pellicle/base/random.h"
#include "pellicle/mask/morphology.h"
#include "pellicle/mask/parts.h"
#include "pellicle/mesh/distance.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/raster/rasterize.h"

namespace pellicle {
namespace {

std::vector<Vec3> on_ball(int count, double radius, RandomEngine& random) {
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i)
    points.push_back(radius * Vec3(random.normal(), random.normal(), random.normal()).normalized());
  return points;
}

void expect_sphere_like(const TriangleMesh& surface) {
  const MeshTopology t = topology_of(surface);
  EXPECT_TRUE(t.closed && t.manifold && t.oriented) << t.first_fault;
  EXPECT_EQ(t.components, 1);
  EXPECT_EQ(t.genus, 0);
  EXPECT_GT(volume_of(surface), 0.0);
}

TEST(SolidOfPoints, HoldsABallOfPoints) {
  RandomEngine random(1);
  for (const int count : {60, 1000, 20000}) {
    const double spacing = 10.0 * std::sqrt(4.0 * std::numbers::pi / count) / 2.0;
    const ClosedSolid solid = solid_of_points(on_ball(count, 10.0, random), spacing);
    expect_sphere_like(solid.surface);
    EXPECT_NEAR(volume_of(solid.surface) / (4.0 / 3.0 * std::numbers::pi * 1000.0), 1.0, count < 100 ? 0.6 : 0.25)
        << count;
  }
}

TEST(SolidOfPoints, BridgesAHole) {
  RandomEngine random(2);
  std::vector<Vec3> points = on_ball(8000, 10.0, random);
  std::erase_if(points, [](const Vec3& x) { return x.z() > 8.5; });
  const ClosedSolid solid = solid_of_points(points, 0.3);
  expect_sphere_like(solid.surface);
  EXPECT_GT(volume_of(solid.surface), 0.6 * 4.0 / 3.0 * std::numbers::pi * 1000.0);
  EXPECT_GT(solid.closing_mm, 0.0);
}

// The hole is 5 mm wide, points lie 2 mm apart: voxels that close over the points close the hole as well.
TEST(SolidOfPoints, SeesAHoleHardlyWiderThanThePointsLieApart) {
  RandomEngine random(3);
  constexpr double kRing = 10.0, kTube = 7.5;
  std::vector<Vec3> points;
  while (points.size() < 700) {
    const double u = 2.0 * std::numbers::pi * random.uniform(), v = 2.0 * std::numbers::pi * random.uniform();
    const double r = kRing + kTube * std::cos(v);
    if (random.uniform() * (kRing + kTube) > r) continue;  // evenly over the area
    points.emplace_back(r * std::cos(u), kTube * std::sin(v), 40.0 + r * std::sin(u));
  }
  const ClosedSolid solid = solid_of_points(points, 1.0);
  EXPECT_EQ(solid.genus_as_given, 1);
  expect_sphere_like(solid.surface);
  const double volume = 2.0 * std::numbers::pi * std::numbers::pi * kRing * kTube * kTube;
  EXPECT_NEAR(volume_of(surface_of_mask(solid.as_given)) / volume, 1.0, 0.06);
}

// Where the field of a thin limb falls below one half for a voxel, the limb goes on behind.
TEST(JoinParts, FollowsTheFieldAndLeavesOutWhatIsFarOrSmall) {
  ImageGrid grid;
  grid.size = {40, 9, 9};
  Image<float> field(grid, 0.0F);
  const auto fill = [&](int from, int to, int half, float value) {
    for (int i = from; i < to; ++i) {
      for (int j = 4 - half; j <= 4 + half; ++j) {
        for (int k = 4 - half; k <= 4 + half; ++k) field.at(i, j, k) = value;
      }
    }
  };
  fill(2, 10, 2, 1.0F);   // the body
  fill(10, 14, 0, 0.3F);  // four voxels of a thread
  fill(14, 20, 1, 1.0F);  // the limb
  fill(21, 22, 0, 1.0F);  // dust
  fill(28, 36, 1, 1.0F);  // something else
  Image<std::uint8_t> mask(grid);
  std::transform(field.voxels.begin(), field.voxels.end(), mask.voxels.begin(),
                 [](float value) { return static_cast<std::uint8_t>(value > 0.5F ? 1 : 0); });
  Image<std::uint8_t> far_from_thread = mask;
  join_parts(mask, field, 8);
  for (int i = 0; i < 40; ++i) EXPECT_EQ(mask.at(i, 4, 4), i >= 2 && i < 20 ? 1 : 0) << i;
  Image<std::uint8_t> largest = mask;
  keep_largest_part(largest);
  EXPECT_EQ(largest.voxels, mask.voxels);
  EXPECT_EQ(topology_of(surface_of_mask(mask)).genus, 0);

  fill(10, 14, 0, 0.0F);  // without the thread it is too far
  join_parts(far_from_thread, field, 8);
  EXPECT_EQ(far_from_thread.at(15, 4, 4), 0);
  EXPECT_EQ(far_from_thread.at(5, 4, 4), 1);
}

TEST(SolidOfPoints, KeepsALimbAsThinAsThreeSpacings) {
  RandomEngine random(4);
  constexpr double kBall = 10.0, kLimb = 1.2, kEnd = 26.0;
  std::vector<Vec3> points = on_ball(1200, kBall, random);
  std::erase_if(points, [](const Vec3& x) { return x.z() > 0.0 && x.head<2>().norm() < kLimb; });
  for (int i = 0; i < 140; ++i) {
    const double u = 2.0 * std::numbers::pi * random.uniform();
    points.emplace_back(kLimb * std::cos(u), kLimb * std::sin(u), kBall + (kEnd - kBall) * random.uniform());
  }
  const ClosedSolid solid = solid_of_points(points, 1.0);
  EXPECT_EQ(solid.genus_as_given, 0);
  const ClosestPoint nearest(surface_of_mask(solid.as_given));
  double farthest = 0.0;
  for (const Vec3& x : points) farthest = std::max(farthest, nearest.query(x).distance);
  EXPECT_LT(farthest, 3.0);
}

TEST(SolidOfPoints, RefusesWhatEnclosesNothing) {
  EXPECT_THROW(solid_of_points({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}, 1.0), BadData);
  EXPECT_THROW(solid_of_points({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(1, 1, 0), Vec3(2, 1, 0)}, 1.0),
               BadData);
}

Image<std::uint8_t> ball_mask(double bore) {
  ImageGrid grid;
  grid.size = {24, 20, 22};
  grid.spacing = {1.0, 1.2, 1.1};
  Image<std::uint8_t> mask(grid);
  for (int k = 0; k < 22; ++k) {
    for (int j = 0; j < 20; ++j) {
      for (int i = 0; i < 24; ++i) {
        const Vec3 x = grid.world_from_index(Vec3(i, j, k)) - Vec3(12, 11.5, 11.5);
        mask.at(i, j, k) = x.norm() < 9.0 && std::hypot(x.x(), x.y()) >= bore ? 1 : 0;
      }
    }
  }
  return mask;
}

TEST(SolidOfMask, KeepsABallAsItIs) {
  const ClosedSolid solid = solid_of_mask(ball_mask(0.0));
  expect_sphere_like(solid.surface);
  EXPECT_EQ(solid.closing_mm, 0.0);
  EXPECT_NEAR(volume_of(solid.surface) / (4.0 / 3.0 * std::numbers::pi * 729.0), 1.0, 0.03);
}

TEST(SolidOfMask, ClosesAHoleThroughItAndFillsACavity) {
  const ClosedSolid bored = solid_of_mask(ball_mask(1.6));
  expect_sphere_like(bored.surface);
  EXPECT_EQ(bored.genus_as_given, 1);
  EXPECT_GT(bored.closing_mm, 0.0);
  Image<std::uint8_t> hollow = ball_mask(0.0);
  hollow.at(12, 10, 10) = 0;
  EXPECT_EQ(solid_of_mask(hollow).closing_mm, 0.0);
  expect_sphere_like(solid_of_mask(hollow).surface);
}

TEST(SolidOfMask, RefusesAnEmptyMask) {
  ImageGrid grid;
  grid.size = {4, 4, 4};
  EXPECT_THROW(solid_of_mask(Image<std::uint8_t>(grid)), BadData);
}

}  // namespace
}  // namespace pellicle
