#include "pellicle/surface/spline/spline_generator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pellicle/base/constants.h"
#include "pellicle/base/errors.h"
#include "spline_cases.h"

namespace pellicle {
namespace {

std::vector<Generator> generators() {
  std::vector<Generator> result{{SplineGenerator::keys, 0}};
  for (const int m : {3, 4, 5, 6, 12, 40, 1000, 1000000}) result.emplace_back(SplineGenerator::exponential, m);
  return result;
}

TEST(SplineGenerator, GoldenValues) {
  const nlohmann::json golden = shapes::spline_golden("phi");
  for (const auto& [m, entry] : golden.at("M").items()) {
    const Generator phi(SplineGenerator::exponential, std::stoi(m));
    EXPECT_NEAR(phi.slope_at_one(), entry.at("phi_prime_at_1").get<double>(), 1e-15);
    for (const auto& row : entry.at("rows")) {
      const GeneratorValue at = phi.at(row.at(0));
      EXPECT_NEAR(at.value, row.at(1).get<double>(), 1e-14) << "M " << m << " t " << row.at(0);
      EXPECT_NEAR(at.first, row.at(2).get<double>(), 1e-13) << "M " << m << " t " << row.at(0);
      EXPECT_NEAR(at.second, row.at(3).get<double>(), 1e-13) << "M " << m << " t " << row.at(0);
    }
  }
}

TEST(SplineGenerator, InterpolatesIsEvenAndSumsToOne) {
  for (const Generator& phi : generators()) {
    for (int k = -3; k <= 3; ++k) EXPECT_NEAR(phi.at(k).value, k == 0 ? 1.0 : 0.0, 1e-15);
    for (double t = 0.0; t < 1.0; t += 0.01) {
      double sum = 0, slopes = 0;
      for (int k = -2; k <= 2; ++k) {
        sum += phi.at(t - k).value;
        slopes += phi.at(t - k).first;
      }
      EXPECT_NEAR(sum, 1.0, 1e-15);
      EXPECT_NEAR(slopes, 0.0, 1e-14);
      for (const double far : {t, 1.0 + t}) {
        EXPECT_EQ(phi.at(far).value, phi.at(-far).value);
        EXPECT_EQ(phi.at(far).first, -phi.at(-far).first);
        EXPECT_EQ(phi.at(far).second, phi.at(-far).second);
      }
    }
    EXPECT_EQ(phi.at(2.0).value, 0.0);
    EXPECT_EQ(phi.at(-5.0).first, 0.0);
    EXPECT_NEAR(phi.at(1.0).first, phi.slope_at_one(), 1e-15);
    EXPECT_NEAR(phi.at(std::nextafter(1.0, 0.0)).first, phi.slope_at_one(), 1e-14) << "C1 at 1";
    EXPECT_NEAR(phi.at(std::nextafter(2.0, 0.0)).first, 0.0, 1e-14) << "C1 at 2";
  }
}

TEST(SplineGenerator, ReproducesCosineAndSine) {
  for (const int m : {4, 5, 6, 12, 40, 1000}) {
    const Generator phi(SplineGenerator::exponential, m);
    for (double t = 0.0; t < 1.0; t += 0.05) {
      double cosine = 0, sine = 0;
      for (int k = -2; k <= 2; ++k) {
        cosine += std::cos(2 * kPi * k / m) * phi.at(t - k).value;
        sine += std::sin(2 * kPi * k / m) * phi.at(t - k).value;
      }
      EXPECT_NEAR(cosine, std::cos(2 * kPi * t / m), 1e-15);
      EXPECT_NEAR(sine, std::sin(2 * kPi * t / m), 1e-15);
    }
  }
}

TEST(SplineGenerator, DerivativesMatchDifferences) {
  for (const Generator& phi : generators()) {
    for (const double t : {-1.73, -1.2, -0.6, -0.001, 0.3, 0.77, 1.31, 1.95}) {
      const double h = 1e-5;
      EXPECT_NEAR((phi.at(t + h).value - phi.at(t - h).value) / (2 * h), phi.at(t).first, 2e-9);
      const double second = (phi.at(t + h).first - phi.at(t - h).first) / (2 * h);
      if (std::abs(t) > 0.01) {
        EXPECT_NEAR(second, phi.at(t).second, 2e-8);
      }
    }
  }
}

TEST(SplineGenerator, KeysIsTheLimitAndTheCubicOfItsName) {
  const Generator keys(SplineGenerator::keys, 0);
  for (double t = 0.0; t < 2.0; t += 0.05) {
    const double cubic = t < 1 ? 1.5 * t * t * t - 2.5 * t * t + 1 : -0.5 * t * t * t + 2.5 * t * t - 4 * t + 2;
    EXPECT_NEAR(keys.at(t).value, cubic, 2e-15);
    for (const int m : {20, 200, 1000000}) {
      const double limit = 0.56 / (static_cast<double>(m) * m) + 2e-16;
      EXPECT_LE(std::abs(Generator(SplineGenerator::exponential, m).at(t).value - keys.at(t).value), limit) << m;
    }
    if (t >= 1) continue;
    double square = 0;  // reproduces quadratics
    for (int k = -2; k <= 2; ++k) square += k * k * keys.at(t - k).value;
    EXPECT_NEAR(square, t * t, 1e-14);
  }
}

TEST(SplineGenerator, RefusesPeriodsWithoutAForm) {
  EXPECT_THROW(Generator(SplineGenerator::exponential, 2), UsageError);
  EXPECT_NO_THROW(Generator(SplineGenerator::keys, 2));
}

}  // namespace
}  // namespace pellicle
