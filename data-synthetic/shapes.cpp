#include "pellicle/synthetic/shapes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pellicle/base/errors.h"
#include "pellicle/base/random.h"

namespace pellicle {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kTiny = 1e-12;
constexpr double kMaxElongation = 20.0;  // truth meshes of longer shapes would not fit their triangle budget

struct Legendre {
  double value, slope;
};

/// P_l and its derivative, l = 2 ... 5.
Legendre legendre(int degree, double t) {
  const double t2 = t * t;
  switch (degree) {
    case 2:
      return {1.5 * t2 - 0.5, 3.0 * t};
    case 3:
      return {(2.5 * t2 - 1.5) * t, 7.5 * t2 - 1.5};
    case 4:
      return {((35.0 * t2 - 30.0) * t2 + 3.0) / 8.0, (35.0 * t2 - 15.0) * t / 2.0};
    default:
      return {((63.0 * t2 - 70.0) * t2 + 15.0) * t / 8.0, ((315.0 * t2 - 210.0) * t2 + 15.0) / 8.0};
  }
}

LevelSample level_of(const EllipsoidShape& s, const Vec3& x) {
  const Vec3 u = x.cwiseQuotient(s.half_axes);
  const double r = std::max(u.norm(), kTiny);
  return {r - 1.0, u.cwiseQuotient(s.half_axes) / r};
}

LevelSample level_of(const SuperquadricShape& s, const Vec3& x) {
  const Vec3 u = x.cwiseQuotient(s.half_axes);
  const double q = u.x() * u.x() * u.x() * u.x() + u.y() * u.y() * u.y() * u.y();
  const double q_root = std::pow(std::max(q, 1e-60), 0.25);
  const double w = std::abs(u.z());
  const double n = std::max(std::cbrt(q_root * q_root * q_root + w * w * w), kTiny);
  // d(n)/d(u) = (q_root^3 + w^3)^(-2/3) (u_x^3 / q_root, u_y^3 / q_root, w |w|)
  const Vec3 du(u.x() * u.x() * u.x() / q_root, u.y() * u.y() * u.y() / q_root, u.z() * w);
  return {n - 1.0, du.cwiseQuotient(s.half_axes) / (n * n)};
}

LevelSample level_of(const BlobShape& s, const Vec3& x) {
  const double r = std::max(x.norm(), kTiny);
  const Vec3 direction = x / r;
  double height = 1.0;
  Vec3 tangential = Vec3::Zero();
  for (const BlobShape::Term& term : s.terms) {
    const double t = term.axis.dot(direction);
    const Legendre p = legendre(term.degree, t);
    height += term.coefficient * p.value;
    tangential += term.coefficient * p.slope * (term.axis - t * direction);
  }
  return {r - s.radius * height, direction - (s.radius / r) * tangential};
}

LevelSample level_of(const BeanShape& s, const Vec3& x) {
  const Vec3& a = s.half_axes;
  const double u = x.x() / a.x();
  const Vec3 straight(x.x(), x.y() - a.y() * (u * u - 0.2), x.z());
  LevelSample sample = level_of(EllipsoidShape{a}, straight);
  sample.gradient.x() -= sample.gradient.y() * a.y() * 2.0 * u / a.x();
  return sample;
}

LevelSample level_of(const DumbbellShape& s, const Vec3& x) {
  const Vec3 from_a = x - Vec3(s.ball_offset, 0, 0), from_b = x + Vec3(s.ball_offset, 0, 0);
  const double norm_a = std::max(from_a.norm(), kTiny), norm_b = std::max(from_b.norm(), kTiny);
  const double lower = std::min(norm_a, norm_b);
  const double exp_a = std::exp((lower - norm_a) / s.blend), exp_b = std::exp((lower - norm_b) / s.blend);
  const double sum = exp_a + exp_b;
  return {lower - s.ball_radius - s.blend * std::log(sum),
          (exp_a / (sum * norm_a)) * from_a + (exp_b / (sum * norm_b)) * from_b};
}

/// x of the tube's origin as seen from the arc's centre.
double tube_shift(const TubeShape& s) {
  return s.arc_radius * std::sin(s.half_angle) / s.half_angle;
}

LevelSample level_of(const TubeShape& s, const Vec3& x) {
  const Vec3 p = x + Vec3(tube_shift(s), 0, 0);
  const double angle = std::clamp(std::atan2(p.y(), p.x()), -s.half_angle, s.half_angle);
  const Vec3 from_arc = p - s.arc_radius * Vec3(std::cos(angle), std::sin(angle), 0);
  const double distance = std::max(from_arc.norm(), kTiny);
  return {distance - s.radius, from_arc / distance};
}

Vec3 bounds_of(const EllipsoidShape& s) {
  return s.half_axes;
}
Vec3 bounds_of(const SuperquadricShape& s) {
  return s.half_axes;
}
Vec3 bounds_of(const BlobShape& s) {
  return Vec3::Constant(s.radius * s.peak);
}
Vec3 bounds_of(const BeanShape& s) {
  return s.half_axes.cwiseProduct(Vec3(1.0, 1.8, 1.0));
}
Vec3 bounds_of(const DumbbellShape& s) {
  // The blend lowers the function by at most k log 2.
  return Vec3(s.ball_offset, 0, 0) + Vec3::Constant(s.ball_radius + s.blend * std::numbers::ln2);
}
Vec3 bounds_of(const TubeShape& s) {
  const double high = s.arc_radius - tube_shift(s);
  const double low = tube_shift(s) - s.arc_radius * std::cos(s.half_angle);
  const double side = s.arc_radius * (s.half_angle < kPi / 2 ? std::sin(s.half_angle) : 1.0);
  return Vec3(std::max(high, low), side, 0) + Vec3::Constant(s.radius);
}

double volume_of_shape(const EllipsoidShape& s) {
  return 4.0 / 3.0 * kPi * s.half_axes.prod();
}

double volume_of_shape(const SuperquadricShape& s) {
  // Sections are super-ellipses of area A (1 - |z|^3)^(2/3), A = 4 G(5/4)^2 / G(3/2); the integral is a beta function.
  const double section = 4.0 * std::pow(std::tgamma(1.25), 2) / std::tgamma(1.5);
  return s.half_axes.prod() * section * 2.0 * std::tgamma(4.0 / 3.0) * std::tgamma(5.0 / 3.0);
}

/// Integral of f over [-1, 1] by the tanh-sinh rule: nodes crowd at both ends, so roots there do no harm.
template <class F>
double integrate(const F& f) {
  constexpr double kStep = 1.0 / 32.0;
  double sum = 0.0;
  for (int k = -110; k <= 110; ++k) {
    const double s = kPi / 2.0 * std::sinh(k * kStep), c = std::cosh(s);
    sum += f(std::tanh(s)) * kPi / 2.0 * std::cosh(k * kStep) / (c * c);
  }
  return sum * kStep;
}

double volume_of_shape(const BlobShape& s) {
  // Integral of r^3 / 3 over the sphere: a polynomial of degree 15 in the direction, so 32 angles are exact.
  constexpr int kAngles = 32;
  const auto ring = [&](double z) {
    const double rho = std::sqrt(std::max(0.0, 1.0 - z * z));
    double sum = 0.0;
    for (int k = 0; k < kAngles; ++k) {
      const double phi = 2.0 * kPi * k / kAngles;
      const double r = -level_of(s, Vec3(rho * std::cos(phi), rho * std::sin(phi), z)).value + 1.0;
      sum += r * r * r / 3.0;
    }
    return sum * 2.0 * kPi / kAngles;
  };
  return integrate(ring);
}

double volume_of_shape(const BeanShape& s) {
  return volume_of_shape(EllipsoidShape{s.half_axes});
}

/// The positive root along the ray from `x` (inside) in a unit direction, by bisection.
double root_along(const DumbbellShape& s, const Vec3& x, const Vec3& direction) {
  double lo = 0.0, hi = 2.0 * (s.ball_offset + s.ball_radius + s.blend);
  for (int k = 0; k < 80; ++k) {
    const double mid = 0.5 * (lo + hi);
    (level_of(s, x + mid * direction).value < 0 ? lo : hi) = mid;
  }
  return lo;
}

double volume_of_shape(const DumbbellShape& s) {
  const double length = root_along(s, Vec3::Zero(), Vec3::UnitX());
  const auto section = [&](double t) {
    const double rho = root_along(s, Vec3(t * length, 0, 0), Vec3::UnitY());
    return kPi * rho * rho * length;
  };
  return integrate(section);
}

double volume_of_shape(const TubeShape& s) {  // Pappus, and two half balls
  return kPi * s.radius * s.radius * (2.0 * s.half_angle * s.arc_radius + 4.0 / 3.0 * s.radius);
}

BlobShape draw_blob(double radius, double amplitude, std::uint64_t seed) {
  RandomEngine random(seed ^ 0xb10bULL);
  const auto direction = [&random] { return Vec3(random.normal(), random.normal(), random.normal()).normalized(); };
  BlobShape blob{radius, 1.0 + 1.03 * amplitude, {}};
  for (int degree = 2; degree <= 5; ++degree) {
    for (int k = 0; k < 3; ++k) {
      const Vec3 axis = direction();
      blob.terms.push_back({degree, axis, random.normal() / (degree - 1.0)});
    }
  }
  double largest = 0.0;
  constexpr int kDirections = 4000;  // golden spiral: 3 degrees apart, the maximum is found to about 1 %
  for (int k = 0; k < kDirections; ++k) {
    const double z = 1.0 - (2.0 * k + 1.0) / kDirections, rho = std::sqrt(1.0 - z * z);
    const double phi = kPi * (3.0 - std::sqrt(5.0)) * k;
    const LevelSample s = level_of(BlobShape{1.0, 1.0, blob.terms}, Vec3(rho * std::cos(phi), rho * std::sin(phi), z));
    largest = std::max(largest, std::abs(s.value));
  }
  for (BlobShape::Term& term : blob.terms) term.coefficient *= amplitude / largest;
  return blob;
}

}  // namespace

const std::vector<std::string>& shape_names() {
  static const std::vector<std::string> names{"sphere", "ellipsoid", "superquadric", "blob",
                                              "bean",   "dumbbell",  "tube"};
  return names;
}

bool shape_has_half_axes(const std::string& name) {
  return name == "ellipsoid" || name == "superquadric" || name == "bean";
}

Shape make_shape(const std::string& name, const std::vector<double>& radius, double amplitude, std::uint64_t seed) {
  if (std::find(shape_names().begin(), shape_names().end(), name) == shape_names().end()) {
    throw UsageError(fmt::format("unknown shape (--shape {}): choose one of {}", name, fmt::join(shape_names(), ", ")));
  }
  const bool valid = std::all_of(radius.begin(), radius.end(), [](double r) { return std::isfinite(r) && r > 0.0; });
  const bool three = radius.size() == 3 && shape_has_half_axes(name);
  if (!valid || (radius.size() != 1 && !three)) {
    throw UsageError(fmt::format("bad radius (--radius {}): shape '{}' takes {}, in mm and above 0",
                                 fmt::join(radius, ","), name,
                                 shape_has_half_axes(name) ? "one scale or three half axes" : "one value"));
  }
  const auto [shortest, longest] = std::minmax_element(radius.begin(), radius.end());
  if (*longest > kMaxElongation * *shortest) {
    throw UsageError(fmt::format("bad radius (--radius {}): the longest half axis may be at most {} times the shortest",
                                 fmt::join(radius, ","), kMaxElongation));
  }
  const double r = radius[0];
  const auto axes = [&](const Vec3& ratio) { return three ? Vec3(radius[0], radius[1], radius[2]) : Vec3(r * ratio); };
  if (name == "sphere") return EllipsoidShape{Vec3::Constant(r)};
  if (name == "ellipsoid") return EllipsoidShape{axes({1.0, 1.3, 0.75})};
  if (name == "superquadric") return SuperquadricShape{axes({1.0, 1.15, 0.85})};
  if (name == "blob") return draw_blob(r, amplitude, seed);
  if (name == "bean") return BeanShape{axes({1.45, 0.85, 0.8})};
  if (name == "dumbbell") return DumbbellShape{0.8 * r, 0.9 * r, 0.28 * r};
  return TubeShape{0.5 * r, 1.1 * r, 1.25};
}

LevelSample level(const Shape& shape, const Vec3& x) {
  return std::visit([&x](const auto& s) { return level_of(s, x); }, shape);
}

Vec3 half_bounds(const Shape& shape) {
  return std::visit([](const auto& s) { return bounds_of(s); }, shape);
}

double exact_volume(const Shape& shape) {
  return std::visit([](const auto& s) { return volume_of_shape(s); }, shape);
}

double Body::distance_near(const Vec3& x_in_world) const {
  const LevelSample s = level_at(x_in_world);
  return s.value / std::max(s.gradient.norm(), 1e-12);
}

Vec3 Body::closest_point_near(const Vec3& x_in_world) const {
  Vec3 y = x_in_world;
  for (int k = 0; k < 20; ++k) {
    LevelSample s = level_at(y);
    const double slope = std::max(s.gradient.norm(), 1e-12);
    const Vec3 normal = s.gradient / slope, offset = x_in_world - y;
    const Vec3 step = offset - offset.dot(normal) * normal - (s.value / slope) * normal;
    y += step;
    if (step.squaredNorm() <= 1e-14 * offset.squaredNorm()) break;
  }
  return y;
}

}  // namespace pellicle
