#include "pellicle/synthetic/degrade.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pellicle/base/parallel.h"

namespace pellicle {
namespace {

ImageGrid cube(int n) {
  return ImageGrid{{n, n, n}, Vec3(1, 1, 1), Vec3::Zero(), Mat3::Identity()};
}

struct Statistics {
  double mean = 0.0, variance = 0.0;
};

Statistics statistics_of(const Image<float>& image) {
  Statistics s;
  for (const float v : image.voxels) s.mean += v;
  s.mean /= static_cast<double>(image.voxels.size());
  for (const float v : image.voxels) s.variance += (v - s.mean) * (v - s.mean);
  s.variance /= static_cast<double>(image.voxels.size() - 1);
  return s;
}

Statistics noisy(PhantomNoise noise, double level, double sd, double reference) {
  Image<float> image(cube(64), static_cast<float>(level));
  apply_noise(image, noise, sd, reference, 42);
  return statistics_of(image);
}

TEST(Noise, GaussianHasItsMeanAndDeviation) {
  const Statistics s = noisy(PhantomNoise::gaussian, 50.0, 4.0, 100.0);  // 262144 voxels
  EXPECT_NEAR(s.mean, 50.0, 4.0 * 4.0 / 512.0);
  EXPECT_NEAR(std::sqrt(s.variance), 4.0, 4.0 * 4.0 / 724.0);
}

TEST(Noise, RicianHasTheRayleighAndTheHighSignalLimits) {
  const double sd = 4.0;
  const Statistics zero = noisy(PhantomNoise::rician, 0.0, sd, 100.0);
  EXPECT_NEAR(zero.mean, sd * std::sqrt(std::numbers::pi / 2.0), 0.03);
  EXPECT_NEAR(zero.variance, sd * sd * (2.0 - std::numbers::pi / 2.0), 0.1);
  const Statistics high = noisy(PhantomNoise::rician, 100.0, sd, 100.0);
  EXPECT_NEAR(high.mean, 100.0 + sd * sd / 200.0, 0.035);
  EXPECT_NEAR(high.variance, sd * sd, 0.2);
  // Second moment: exact at any level, E m^2 = v^2 + 2 sd^2.
  const Statistics low = noisy(PhantomNoise::rician, 6.0, sd, 100.0);
  EXPECT_NEAR(low.variance + low.mean * low.mean, 36.0 + 2.0 * sd * sd, 0.6);
}

TEST(Noise, PoissonVarianceIsProportionalToTheIntensity) {
  for (const double level : {1.0, 20.0, 100.0}) {
    const Statistics s = noisy(PhantomNoise::poisson, level, 16.0, 100.0);
    EXPECT_NEAR(s.mean, level, 4.0 * std::sqrt(level * 2.56) / 512.0);
    EXPECT_NEAR(s.variance / (level * 2.56), 1.0, 0.03) << level;
  }
  EXPECT_EQ(noisy(PhantomNoise::poisson, 0.0, 16.0, 100.0).variance, 0.0);
}

TEST(Noise, NeighboursRowsAndSlicesAreIndependent) {
  const int n = 64;
  Image<float> image(cube(n), 0.0F);
  apply_noise(image, PhantomNoise::gaussian, 1.0, 1.0, 7);
  for (const Index3& step : {Index3{1, 0, 0}, Index3{2, 0, 0}, Index3{0, 1, 0}, Index3{1, 1, 0}, Index3{0, 0, 1}}) {
    double product = 0.0;
    int pairs = 0;
    for (int k = 0; k + step[2] < n; ++k) {
      for (int j = 0; j + step[1] < n; ++j) {
        for (int i = 0; i + step[0] < n; ++i, ++pairs) {
          product += image.at(i, j, k) * image.at(i + step[0], j + step[1], k + step[2]);
        }
      }
    }
    EXPECT_LE(std::abs(product / pairs), 4.0 / std::sqrt(pairs));
  }
}

TEST(Noise, ComesFromItsSeed) {
  Image<float> a(cube(16), 0.0F), b(cube(16), 0.0F), c(cube(16), 0.0F);
  apply_noise(a, PhantomNoise::gaussian, 1.0, 1.0, 7);
  apply_noise(b, PhantomNoise::gaussian, 1.0, 1.0, 7);
  apply_noise(c, PhantomNoise::gaussian, 1.0, 1.0, 8);
  EXPECT_EQ(a.voxels, b.voxels);
  EXPECT_NE(a.voxels, c.voxels);
}

TEST(Bias, RunsFromOneMinusToOnePlusItsAmplitudeAndIsSmooth) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Image<float> image(cube(48), 100.0F);
    apply_bias(image, 0.25, seed);
    const auto [low, high] = std::minmax_element(image.voxels.begin(), image.voxels.end());
    EXPECT_NEAR(*low, 75.0, 0.5);
    EXPECT_NEAR(*high, 125.0, 0.5);
    for (int i = 0; i + 1 < 48; ++i) ASSERT_LE(std::abs(image.at(i, 24, 24) - image.at(i + 1, 24, 24)), 5.0);
  }
}

TEST(Bias, IsAFieldOfTheWorldNotOfTheVoxels) {
  // Twice as many voxels over the same volume: the same field where the centres agree to within the coarser's step.
  ImageGrid coarse = cube(31), fine = cube(61);
  fine.spacing = Vec3(0.5, 0.5, 0.5);
  coarse.origin_in_world = Vec3(-15, -15, -15);
  fine.origin_in_world = Vec3(-15, -15, -15);
  Image<float> a(coarse, 100.0F), b(fine, 100.0F);
  apply_bias(a, 0.25, 3);
  apply_bias(b, 0.25, 3);
  for (int n = 0; n < 31; ++n) EXPECT_NEAR(a.at(n, 30 - n, 7), b.at(2 * n, 60 - 2 * n, 14), 1.5);
}

}  // namespace
}  // namespace pellicle
