#include <algorithm>
#include <cmath>
#include <numbers>

#include "pellicle/base/constants.h"
#include "pellicle/synthetic/shapes.h"

namespace pellicle {
namespace {

double volume_of_shape(const EllipsoidShape& s, const Shape& /*shape*/) {
  return 4.0 / 3.0 * kPi * s.half_axes.prod();
}

double volume_of_shape(const SuperquadricShape& s, const Shape& /*shape*/) {
  // Sections are super-ellipses of area A (1 - |z|^3)^(2/3), A = 4 G(5/4)^2 / G(3/2); the integral is a beta function.
  const double section = 4.0 * std::pow(std::tgamma(1.25), 2) / std::tgamma(1.5);
  return s.half_axes.prod() * section * 2.0 * std::tgamma(4.0 / 3.0) * std::tgamma(5.0 / 3.0);
}

/// Integral of f over [-1, 1] by the tanh-sinh rule: nodes crowd at both ends, so roots there do no harm.
template <class F>
double integrate(const F& f, int nodes_a_unit = 32) {
  const double step = 1.0 / nodes_a_unit;
  const int last = 110 * nodes_a_unit / 32;
  double sum = 0.0;
  for (int k = -last; k <= last; ++k) {
    const double s = kPi / 2.0 * std::sinh(k * step), c = std::cosh(s);
    sum += f(std::tanh(s)) * kPi / 2.0 * std::cosh(k * step) / (c * c);
  }
  return sum * step;
}

double volume_of_shape(const BlobShape&, const Shape& shape) {
  // Integral of r^3 / 3 over the sphere: a polynomial of degree 15 in the direction, so 32 angles are exact.
  constexpr int kAngles = 32;
  const auto ring = [&](double z) {
    const double rho = std::sqrt(std::max(0.0, 1.0 - z * z));
    double sum = 0.0;
    for (int k = 0; k < kAngles; ++k) {
      const double phi = 2.0 * kPi * k / kAngles;
      const double r = -level(shape, Vec3(rho * std::cos(phi), rho * std::sin(phi), z)).value + 1.0;
      sum += r * r * r / 3.0;
    }
    return sum * 2.0 * kPi / kAngles;
  };
  return integrate(ring);
}

double volume_of_shape(const BeanShape& s, const Shape& shape) {
  return volume_of_shape(EllipsoidShape{s.half_axes}, shape);
}

/// The positive root along the ray from `x` (inside) in a unit direction, by bisection.
double root_along(const Shape& shape, const Vec3& x, const Vec3& direction, double reach) {
  double lo = 0.0, hi = reach;
  for (int k = 0; k < 80; ++k) {
    const double mid = 0.5 * (lo + hi);
    (level(shape, x + mid * direction).value < 0 ? lo : hi) = mid;
  }
  return lo;
}

double volume_of_shape(const DumbbellShape& s, const Shape& shape) {
  const double reach = 2.0 * (s.ball_offset + s.ball_radius + s.blend);
  const double length = root_along(shape, Vec3::Zero(), Vec3::UnitX(), reach);
  const auto section = [&](double t) {
    const double rho = root_along(shape, Vec3(t * length, 0, 0), Vec3::UnitY(), reach);
    return kPi * rho * rho * length;
  };
  return integrate(section);
}

double volume_of_shape(const TubeShape& s, const Shape& /*shape*/) {  // Pappus, and two half balls
  return kPi * s.radius * s.radius * (2.0 * s.half_angle * s.arc_radius + 4.0 / 3.0 * s.radius);
}

double volume_of_shape(const TorusShape& s, const Shape& /*shape*/) {
  return 2.0 * kPi * kPi * s.major * s.minor * s.minor;
}

/// Where `shape` ends above (x, y, 0), which lies inside: Newton in z^2, in which the function is nearly linear, kept
/// between bounds that close in.
double half_height(const Shape& shape, double x, double y, double reach) {
  double low = 0.0, high = reach * reach, w = high;
  for (int k = 0; k < 100; ++k) {
    const double z = std::sqrt(w);
    const LevelSample s = level(shape, Vec3(x, y, z));
    (s.value < 0.0 ? low : high) = w;
    const double newton = w - 2.0 * z * s.value / s.gradient.z();
    const double next = newton > low && newton < high ? newton : 0.5 * (low + high);
    if (std::abs(next - w) <= 1e-15 * reach * reach) return std::sqrt(next);
    w = next;
  }
  return std::sqrt(w);
}

/// Eight times the octant: over the sections across x, which change their topology where the hole begins and ends.
/// There the section's area has a logarithm; the tanh-sinh rule between these places does not mind.
double volume_of_shape(const DoubleTorusShape& s, const Shape& shape) {
  constexpr int kNodes = 16;  // against 32: differs by less than 1e-11
  const double half = s.minor + s.blend * std::numbers::ln2;
  const auto value = [&shape](double x, double y) { return level(shape, Vec3(x, y, 0)).value; };
  const auto root = [](double inside, double outside, const auto& f) {
    for (int k = 0; k < 80; ++k) {
      const double mid = 0.5 * (inside + outside);
      (f(mid) < 0.0 ? inside : outside) = mid;
    }
    return inside;
  };
  const auto section = [&](double x) {
    const double in_plane = x - s.major, across = s.major * s.major - in_plane * in_plane;
    const double ring = std::sqrt(std::max(0.0, across));
    const auto along_y = [&](double y) { return value(x, y); };
    const double first = along_y(0.0) < 0.0 ? 0.0 : root(ring, 0.0, along_y);
    const double last = root(std::max(ring, first), s.major + half, along_y);
    const auto height = [&](double t) {
      const double y = first + 0.5 * (1.0 + t) * (last - first);
      return value(x, y) < 0.0 ? half_height(shape, x, y, half) : 0.0;
    };
    return 0.5 * (last - first) * integrate(height, kNodes);
  };
  const auto along_x = [&](double x) { return value(x, 0.0); };
  const double ends[4] = {0.0, root(0.0, s.major, along_x), root(2.0 * s.major, s.major, along_x),
                          root(2.0 * s.major, 2.0 * s.major + half, along_x)};
  double sum = 0.0;
  for (int piece = 0; piece < 3; ++piece) {
    const double from = ends[piece], length = ends[piece + 1] - from;
    sum += 0.5 * length * integrate([&](double t) { return section(from + 0.5 * (1.0 + t) * length); }, kNodes);
  }
  return 8.0 * sum;
}

}  // namespace

double exact_volume(const Shape& shape) {
  return std::visit([&shape](const auto& s) { return volume_of_shape(s, shape); }, shape);
}

}  // namespace pellicle
