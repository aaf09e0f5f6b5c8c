#include "pellicle/surface/spline/spline_generator.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "pellicle/base/errors.h"

namespace pellicle {
namespace {

double sinc(double x) {
  return x == 0.0 ? 1.0 : std::sin(x) / x;
}

/// (1 - cos x) / x^2
double c2(double x) {
  const double half = sinc(0.5 * x);
  return 0.5 * half * half;
}

/// (x - sin x) / x^3; the quotient cancels near zero, the series does not.
double s3(double x) {
  const double x2 = x * x;
  if (x2 > 1.0) return (x - std::sin(x)) / (x2 * x);
  constexpr double divisors[] = {272, 210, 156, 110, 72, 42, 20};  // (2k+2)(2k+3), the smallest term first
  double sum = 1.0;
  for (const double d : divisors) sum = 1.0 - x2 / d * sum;
  return sum / 6.0;
}

// theta -> 0 turns the exponential generator into Keys': one set of formulas for both.
double angle(SplineGenerator kind, int m) {
  if (kind == SplineGenerator::keys) return 0.0;
  if (m < 3)
    throw UsageError(fmt::format("spline generator (M = {}): has no exponential form; M must be 3 or more", m));
  return std::numbers::pi / m;
}

}  // namespace

Generator::Generator(SplineGenerator kind, int m)
    : theta_(angle(kind, m)),
      slope_(-0.5 / sinc(2.0 * theta_)),
      sinc_(sinc(theta_)),
      c2_(c2(theta_)),
      s3_(s3(theta_)),
      k_(c2_ - s3_) {}

/// Rises from 0 at r = -1/2 to 1 at r = 1/2 with slope 0 at both ends.
GeneratorValue Generator::step_up(double r) const {
  const double x = 2.0 * theta_ * r, r2 = 4.0 * r * r;
  return {0.5 + r * (c2_ - r2 * s3(x)) / k_, (c2_ - r2 * c2(x)) / k_, -4.0 * r * sinc(x) / k_};
}

/// Zero at both ends, slope 0 at r = -1/2 and 1 at r = 1/2.
GeneratorValue Generator::end_slope(double r) const {
  const double x = 2.0 * theta_ * r, r2 = 4.0 * r * r;
  return {(r2 * c2(x) - c2_) / (4.0 * sinc_) + r * (r2 * s3(x) - s3_) / (2.0 * k_),
          r * sinc(x) / sinc_ + (r2 * c2(x) - s3_) / (2.0 * k_), std::cos(x) / sinc_ + 2.0 * r * sinc(x) / k_};
}

GeneratorValue Generator::at(double t) const {
  const double a = std::abs(t);
  if (!(a < 2.0)) return {};
  GeneratorValue result;
  if (a < 1.0) {
    const GeneratorValue e = step_up(a - 0.5), h = end_slope(a - 0.5);
    result = {1.0 - e.value + slope_ * h.value, -e.first + slope_ * h.first, -e.second + slope_ * h.second};
  } else {
    const GeneratorValue h = end_slope(1.5 - a);
    result = {-slope_ * h.value, slope_ * h.first, -slope_ * h.second};
  }
  if (t < 0.0) result.first = -result.first;
  return result;
}

}  // namespace pellicle
