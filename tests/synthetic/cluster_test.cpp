#include "pellicle/synthetic/cluster.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

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

TEST(Cluster, ContrastsFillTheirRange) {
  ClusterSettings s = small_cluster();
  s.count = 40;
  s.radius_min = s.radius_max = 1.5;
  s.contrast_max = 0.8;
  const Cluster cluster = make_cluster(s);
  const auto [low, high] = std::minmax_element(cluster.contrast.begin(), cluster.contrast.end());
  EXPECT_GE(*low, 0.2);
  EXPECT_LE(*low, 0.25);
  EXPECT_GE(*high, 0.65);
  EXPECT_LE(*high, 0.8);
}

TEST(Cluster, SeedsLieInTheirObjects) {
  const Cluster cluster = make_cluster(small_cluster());
  ASSERT_EQ(cluster.seeds.size(), cluster.bodies.size());
  for (std::size_t i = 0; i < cluster.bodies.size(); ++i) {
    EXPECT_LT(cluster.bodies[i].level_at(cluster.seeds[i].center).value, 0.0);
    const Vec3 index = cluster.truth.grid.index_from_world(cluster.seeds[i].center);
    const int label =
        cluster.truth.at(static_cast<int>(std::lround(index.x())), static_cast<int>(std::lround(index.y())),
                         static_cast<int>(std::lround(index.z())));
    EXPECT_EQ(label, static_cast<int>(i) + 1);
  }
}

TEST(Cluster, TruthJsonRebuildsEveryObject) {
  const Cluster cluster = make_cluster(small_cluster());
  const auto json = nlohmann::json::parse(truth_json(cluster));
  EXPECT_EQ(json["shape"], "cluster");
  EXPECT_EQ(json["settings"]["count"], 8);
  ASSERT_EQ(json["objects"].size(), 8U);
  double sum = 0.0;
  for (std::size_t i = 0; i < 8; ++i) {
    const auto& object = json["objects"][i];
    EXPECT_EQ(object["label"].get<std::size_t>(), i + 1);
    EXPECT_EQ(object["contrast"].get<double>(), cluster.contrast[i]);
    const auto vec = [](const nlohmann::json& v) {
      return Vec3(v[0].get<double>(), v[1].get<double>(), v[2].get<double>());
    };
    // The tip of each half axis lies on the exact surface.
    for (std::size_t a = 0; a < 3; ++a) {
      const Vec3 tip = vec(object["center"]) + object["half_axes"][a].get<double>() * vec(object["axes"][a]);
      EXPECT_LE(std::abs(cluster.bodies[i].distance_near(tip)), 1e-12);
    }
    sum += object["exact_volume_ml"].get<double>();
  }
  EXPECT_NEAR(json["exact_volume_ml"].get<double>(), sum, 1e-12);
}

TEST(Cluster, RefusesWhatDoesNotFitWithTheFlagAndTheRule) {
  const auto message = [](const auto& change) -> std::string {
    ClusterSettings s = small_cluster();
    change(s);
    try {
      make_cluster(s);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "accepted";
  };
  using S = ClusterSettings;
  EXPECT_NE(message([](S& s) { s.count = 500; }).find("no room for all objects (count 500)"), std::string::npos);
  EXPECT_NE(message([](S& s) { s.count = 0; }).find("(count 0)"), std::string::npos);
  EXPECT_NE(message([](S& s) { s.radius_max = 1.0; }).find("(radius 3,1)"), std::string::npos);
  EXPECT_NE(message([](S& s) { s.radius_max = 50.0, s.radius_min = 49; }).find("(size 80,72,40)"), std::string::npos);
  EXPECT_NE(message([](S& s) { s.elongation = 0.5; }).find("(elongation 0.5)"), std::string::npos);
  EXPECT_NE(message([](S& s) { s.distance = std::nan(""); }).find("(distance nan)"), std::string::npos);
  EXPECT_NE(message([](S& s) { s.contrast_min = 2.0; }).find("(contrast-range 2,1)"), std::string::npos);
  EXPECT_NE(message([](S& s) { s.image.bias = 1.0; }).find("bias 1"), std::string::npos);
}

}  // namespace
}  // namespace pellicle
