// Detection of many objects: size, places, territories, and what they must not depend on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "pellicle/seed/blob_scale_space.h"
#include "pellicle/seed/territories.h"
#include "pellicle/synthetic/cluster.h"

namespace pellicle {
namespace {

Cluster balls(const Vec3& spacing, double radius, int count, std::uint64_t seed = 5) {
  ClusterSettings s;
  s.image.spacing = spacing;
  for (int a = 0; a < 3; ++a) {
    s.image.size[static_cast<std::size_t>(a)] = static_cast<int>(std::lround(13.0 * radius / spacing[a]));
  }
  s.image.snr = 8.0;
  s.image.seed = seed;
  s.count = count;
  s.radius_min = s.radius_max = radius;
  s.elongation = 1.0;
  return make_cluster(s);
}

/// How many bodies have exactly one seed nearer to their centre than half their radius.
int found(const Cluster& cluster, const std::vector<BlobSeed>& seeds) {
  int count = 0;
  for (const Body& body : cluster.bodies) {
    int here = 0;
    for (const BlobSeed& seed : seeds)
      here += (seed.position - body.center).norm() < 0.5 * cluster.settings.radius_min ? 1 : 0;
    count += here == 1 ? 1 : 0;
  }
  return count;
}

TEST(Blobs, RadiusIsEstimatedAtAnySpacing) {
  for (const double thick : {1.0, 2.5, 5.0}) {
    const double fine = 0.7 / std::cbrt(thick);
    const Cluster cluster = balls({fine, fine, fine * thick}, 4.0, 12);
    const auto radius = estimate_radius(blob_field(cluster.image, false), {});
    ASSERT_TRUE(radius.has_value());
    EXPECT_NEAR(*radius, 4.0, 0.15 * 4.0) << thick;
  }
}

TEST(Blobs, EveryBallIsFoundOnce) {
  const Cluster cluster = balls({0.6, 0.6, 1.0}, 4.0, 14);
  const BlobField field = blob_field(cluster.image, false);
  const auto seeds = find_blobs(field, 4.0);
  EXPECT_EQ(found(cluster, seeds), 14);
  EXPECT_EQ(seeds.size(), 14U);
  EXPECT_TRUE(
      std::is_sorted(seeds.begin(), seeds.end(), [](const auto& a, const auto& b) { return a.response > b.response; }));
}

TEST(Blobs, DimOnesAreFoundBesideBrightOnes) {
  ClusterSettings s = balls({0.7, 0.7, 0.7}, 4.0, 10).settings;
  s.contrast_min = 0.1;
  s.image.snr = 30.0;
  const Cluster cluster = make_cluster(s);
  EXPECT_EQ(found(cluster, find_blobs(blob_field(cluster.image, false), 4.0)), 10);
}

TEST(Blobs, ScaleOffsetAndSignOfTheIntensitiesDoNotMatter) {
  const Cluster cluster = balls({0.8, 0.8, 0.8}, 4.0, 8);
  Image<float> other = cluster.image, negative = cluster.image;
  for (float& v : other.voxels) v = 64.0F * v + 4096.0F;  // powers of two: the same values to the last bit
  for (float& v : negative.voxels) v = -v;
  const auto seeds = find_blobs(blob_field(cluster.image, false), 4.0);
  for (const auto& same : {find_blobs(blob_field(other, false), 4.0), find_blobs(blob_field(negative, true), 4.0)}) {
    ASSERT_EQ(same.size(), seeds.size());
    for (std::size_t i = 0; i < seeds.size(); ++i) EXPECT_LT((same[i].position - seeds[i].position).norm(), 1e-9);
  }
  EXPECT_FALSE(looks_dark(cluster.image));
  EXPECT_TRUE(looks_dark(negative));
}

TEST(Blobs, NoiseAloneIsNoObject) {
  Image<float> image(ImageGrid{.size = {48, 48, 48}});
  RandomEngine random(3);
  for (float& v : image.voxels) v = static_cast<float>(100.0 + 10.0 * random.normal());
  const BlobField field = blob_field(image, false);
  EXPECT_FALSE(estimate_radius(field, {}).has_value());
  EXPECT_TRUE(find_blobs(field, 4.0).empty());
}

TEST(Territories, HalvesOfASymmetricPairMeetInTheMiddle) {
  Image<float> response(ImageGrid{.size = {21, 9, 9}});
  const auto peak = [](double x) { return std::exp(-0.1 * x * x); };
  for (int k = 0; k < 9; ++k) {
    for (int j = 0; j < 9; ++j) {
      for (int i = 0; i < 21; ++i) {
        const double r2 = std::pow(j - 4, 2) + std::pow(k - 4, 2);
        response.at(i, j, k) = static_cast<float>(std::exp(-0.05 * r2) * (peak(i - 5) + peak(i - 15)));
      }
    }
  }
  const auto owner = territories_of(response, {Vec3(5, 4, 4), Vec3(15, 4, 4)});
  for (int k = 0; k < 9; ++k) {
    for (int j = 0; j < 9; ++j) {
      for (int i = 0; i < 21; ++i) {
        if (i < 10) {
          EXPECT_EQ(owner.at(i, j, k), 1);
        }
        if (i > 10) {
          EXPECT_EQ(owner.at(i, j, k), 2);
        }
      }
    }
  }
}

TEST(Territories, EveryVoxelBelongsToASeed) {
  Image<float> response(ImageGrid{.size = {12, 10, 8}});
  RandomEngine random(1);
  for (float& v : response.voxels) v = static_cast<float>(random.normal());
  const std::vector<Vec3> seeds{{1, 1, 1}, {10, 8, 6}, {10, 8, 6}, {-50, 4, 4}};
  const auto owner = territories_of(response, seeds);
  EXPECT_THAT(owner.voxels, testing::Each(testing::AllOf(testing::Ge(1), testing::Le(4))));
  EXPECT_THAT(owner.voxels, testing::Not(testing::Contains(3)));  // the second of two seeds in one voxel
  EXPECT_EQ(owner.at(0, 4, 4), 4);                                // the nearest voxel of a seed outside
}

}  // namespace
}  // namespace pellicle
