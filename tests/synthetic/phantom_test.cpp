#include "pellicle/synthetic/phantom.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <numeric>

#include "pellicle/base/errors.h"
#include "pellicle/base/parallel.h"
#include "test_names.h"

namespace pellicle {
namespace {

PhantomSettings small(const std::string& shape) {
  PhantomSettings settings;
  settings.shape = shape;
  settings.size = {56, 56, 56};
  settings.radius = {12.0};
  return settings;
}

double mask_volume(const Phantom& phantom) {
  const double count = std::accumulate(phantom.truth.voxels.begin(), phantom.truth.voxels.end(), 0.0);
  return count * phantom.truth.grid.voxel_volume() / 1000.0;
}

class EveryPhantom : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Shapes, EveryPhantom, testing::ValuesIn(shape_names()), shape_test_name);

TEST_P(EveryPhantom, OtherGridsSeeTheSameObject) {
  PhantomSettings settings = small(GetParam());
  const Phantom plain = make_phantom(settings);
  settings.size = {90, 90, 40};
  settings.spacing = Vec3(0.6, 0.6, 1.5);
  settings.direction_degrees = Vec3(20, -30, 70);
  const Phantom oblique = make_phantom(settings);
  ASSERT_EQ(plain.truth_surface.vertices.size(), oblique.truth_surface.vertices.size());
  for (std::size_t v = 0; v < plain.truth_surface.vertices.size(); ++v) {
    ASSERT_EQ(plain.truth_surface.vertices[v], oblique.truth_surface.vertices[v]);
  }
  EXPECT_EQ(plain.exact_volume_ml, oblique.exact_volume_ml);
  EXPECT_LE(std::abs(mask_volume(plain) / plain.exact_volume_ml - 1.0), 0.008);
  EXPECT_LE(std::abs(mask_volume(oblique) / plain.exact_volume_ml - 1.0), 0.008);
  EXPECT_LE((oblique.image.grid.direction.transpose() * oblique.image.grid.direction - Mat3::Identity()).norm(), 1e-12);
  const Vec3 middle = oblique.image.grid.world_from_index(Vec3(44.5, 44.5, 19.5));
  EXPECT_LE(middle.norm(), 1e-9);
}

TEST_P(EveryPhantom, SameBytesForOneAndTwoThreads) {
  PhantomSettings settings = small(GetParam());
  settings.bias = 0.25;
  settings.fill = PhantomFill::shell;
  settings.noise = PhantomNoise::rician;
  const auto run = [&settings](int threads) {
    const ThreadLimit limit(threads);
    return make_phantom(settings);
  };
  const Phantom one = run(1), two = run(2);
  EXPECT_EQ(std::memcmp(one.image.voxels.data(), two.image.voxels.data(), one.image.voxels.size() * sizeof(float)), 0);
  EXPECT_EQ(one.truth.voxels, two.truth.voxels);
  EXPECT_EQ(one.truth_surface.vertices, two.truth_surface.vertices);
  EXPECT_EQ(one.truth_surface.triangles, two.truth_surface.triangles);
  EXPECT_EQ(truth_json(one), truth_json(two));
}

TEST_P(EveryPhantom, SeedsKeepTheirRules) {
  const Phantom phantom = make_phantom(small(GetParam()));
  RandomEngine random(3);
  const auto seeds = draw_seeds(phantom, 500, random);
  ASSERT_EQ(seeds.size(), 500U);
  double farthest = 0.0, smallest = 1e300, largest = 0.0;
  for (const SeedDraw& seed : seeds) {
    EXPECT_LT(phantom.body.level_at(seed.center).value, 0.0);
    farthest = std::max(farthest, (seed.center - phantom.natural_center).norm() / phantom.inner_radius);
    smallest = std::min(smallest, seed.radius / phantom.inner_radius);
    largest = std::max(largest, seed.radius / phantom.inner_radius);
  }
  EXPECT_LE(farthest, 0.4 + 1e-12);
  EXPECT_GE(farthest, 0.38);
  EXPECT_GE(smallest, 0.25);
  EXPECT_LE(smallest, 0.27);
  EXPECT_LE(largest, 1.2);
  EXPECT_GE(largest, 1.18);
  EXPECT_EQ(phantom.seeds.size(), 8U);
}

TEST(Phantom, IntensitiesAreThoseAskedFor) {
  PhantomSettings settings = small("ellipsoid");
  settings.noise = PhantomNoise::none;
  settings.inside = -30.0;
  settings.outside = 70.0;
  const Phantom phantom = make_phantom(settings);
  EXPECT_NEAR(phantom.image.at(0, 0, 0), 70.0F, 1e-4);
  EXPECT_NEAR(phantom.image.at(28, 28, 28), -30.0F, 1e-3);
}

TEST(Phantom, ShellIsBrightOnTheSurfaceAndDarkOnBothSides) {
  PhantomSettings settings = small("sphere");
  settings.noise = PhantomNoise::none;
  settings.fill = PhantomFill::shell;
  settings.shell_thickness_mm = 4.0;
  settings.blur_mm = 0.5;
  const Phantom phantom = make_phantom(settings);
  const auto along_x = [&](double r) {
    const Vec3 index = phantom.image.grid.index_from_world(Vec3(r, 0, 0));
    return phantom.image.at(static_cast<int>(std::lround(index.x())), 28, 28);
  };
  EXPECT_NEAR(along_x(0.0), 20.0, 0.1);
  EXPECT_NEAR(along_x(12.0), 100.0, 0.5);
  EXPECT_NEAR(along_x(20.0), 20.0, 0.1);
  EXPECT_LE(std::abs(mask_volume(phantom) / phantom.exact_volume_ml - 1.0), 0.01) << "the truth stays the solid";
}

TEST(Phantom, NoiseHasTheRatioAskedFor) {
  PhantomSettings settings = small("sphere");
  settings.snr = 4.0;
  const Phantom noisy = make_phantom(settings);
  settings.noise = PhantomNoise::none;
  const Phantom clean = make_phantom(settings);
  double sum = 0.0;
  for (std::size_t n = 0; n < clean.image.voxels.size(); ++n) {
    sum += std::pow(noisy.image.voxels[n] - clean.image.voxels[n], 2);
  }
  EXPECT_NEAR(80.0 / std::sqrt(sum / static_cast<double>(clean.image.voxels.size())), 4.0, 0.04);
}

TEST(Phantom, TruthJsonHoldsWhatAScriptNeeds) {
  PhantomSettings settings = small("bean");
  settings.center = Vec3(1, 2, 3);
  const Phantom phantom = make_phantom(settings);
  const auto json = nlohmann::json::parse(truth_json(phantom));
  EXPECT_EQ(json["shape"], "bean");
  EXPECT_EQ(json["exact_volume_ml"].get<double>(), phantom.exact_volume_ml);
  EXPECT_EQ(json["inner_radius"].get<double>(), phantom.inner_radius);
  EXPECT_EQ(json["center"], nlohmann::json({1.0, 2.0, 3.0}));
  ASSERT_EQ(json["seeds"].size(), 8U);
  EXPECT_EQ(json["seeds"][7]["radius"].get<double>(), phantom.seeds[7].radius);
  EXPECT_EQ(json["settings"]["noise"], "gaussian");
  EXPECT_EQ(json["settings"]["seed"], 1);
  EXPECT_EQ(json["space"], "LPS");
}

TEST(Phantom, RefusesSettingsWithTheFlagAndTheRule) {
  const auto message = [](const auto& change) -> std::string {
    PhantomSettings settings = small("ellipsoid");
    change(settings);
    try {
      make_phantom(settings);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "accepted";
  };
  using S = PhantomSettings;
  EXPECT_NE(message([](S& s) { s.shape = "cube"; }).find("shape cube"), std::string::npos);
  EXPECT_NE(message([](S& s) { s.size[1] = 0; }).find("size 56,0,56"), std::string::npos);
  EXPECT_NE(message([](S& s) { s.size = {8000, 8000, 8000}; }).find("2^31"), std::string::npos);
  EXPECT_NE(message([](S& s) { s.spacing[2] = 0.0; }).find("spacing 1,1,0"), std::string::npos);
  EXPECT_NE(message([](S& s) { s.radius = {1, 2}; }).find("radius 1,2"), std::string::npos);
  EXPECT_NE(message([](S& s) { s.blur_mm = -1.0; }).find("blur -1"), std::string::npos);
  EXPECT_NE(message([](S& s) { s.blur_mm = std::nan(""); }).find("blur nan"), std::string::npos);
  EXPECT_NE(message([](S& s) { s.bias = 1.0; }).find("bias 1"), std::string::npos);
  EXPECT_NE(message([](S& s) { s.snr = 0.0; }).find("snr 0"), std::string::npos);
  EXPECT_NE(message([](S& s) { s.inside = s.outside; }).find("contrast"), std::string::npos);
  EXPECT_NE(message([](S& s) { s.noise = PhantomNoise::poisson, s.outside = -1; }).find("Poisson"), std::string::npos);
  EXPECT_NE(message([](S& s) { s.center = Vec3(500, 0, 0); }).find("center 500,0,0"), std::string::npos);
  EXPECT_NE(message([](S& s) { s.fill = PhantomFill::shell, s.shell_thickness_mm = 50; }).find("shell-thickness"),
            std::string::npos);
}

}  // namespace
}  // namespace pellicle
