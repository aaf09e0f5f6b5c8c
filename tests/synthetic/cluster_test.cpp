#include "pellicle/synthetic/cluster.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pellicle/base/errors.h"
#include "pellicle/base/parallel.h"

namespace pellicle {
namespace {

ClusterSettings small_cluster() {
  ClusterSettings s;
  s.image.size = {80, 72, 40};
  s.image.spacing = Vec3(0.5, 0.5, 1.0);
  s.image.blur_mm = 0.4;
  s.image.noise = PhantomNoise::none;
  s.count = 8;
  s.radius_min = 3.0;
  s.radius_max = 5.0;
  s.distance = 1.2;
  s.contrast_min = 0.2;
  return s;
}

TEST(Cluster, LabelsHaveTheVolumesAndTheImageTheContrasts) {
  const ClusterSettings s = small_cluster();
  const Cluster cluster = make_cluster(s);
  ASSERT_EQ(cluster.bodies.size(), 8U);
  std::vector<double> volume(9, 0.0);
  for (const auto label : cluster.truth.voxels) volume.at(label) += 0.25;
  double signal = 0.0, expected = 0.0;
  for (const float value : cluster.image.voxels) signal += 0.25 * (static_cast<double>(value) - 20.0) / 80.0;
  for (std::size_t i = 0; i < 8; ++i) {
    const double exact = exact_volume(cluster.bodies[i].shape);
    EXPECT_NEAR(volume[i + 1] / exact, 1.0, 0.04) << i;
    expected += cluster.contrast[i] * exact;
  }
  EXPECT_NEAR(signal / expected, 1.0, 0.01);
}

TEST(Cluster, SameBytesForAnyThreadCountAndAnotherSeedDiffers) {
  ClusterSettings s = small_cluster();
  s.image.noise = PhantomNoise::gaussian;
  const Cluster all = make_cluster(s);
  {
    const ThreadLimit limit(1);
    const Cluster one = make_cluster(s);
    EXPECT_EQ(one.image.voxels, all.image.voxels);
    EXPECT_EQ(one.truth.voxels, all.truth.voxels);
  }
  s.image.seed = 2;
  EXPECT_NE(make_cluster(s).truth.voxels, all.truth.voxels);
}

TEST(Cluster, TooManyObjectsAreRefused) {
  ClusterSettings s = small_cluster();
  s.count = 500;
  EXPECT_THROW(make_cluster(s), UsageError);
}

}  // namespace
}  // namespace pellicle
