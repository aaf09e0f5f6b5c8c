#include "pellicle/synthetic/shapes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pellicle/base/constants.h"
#include "pellicle/base/errors.h"
#include "pellicle/base/random.h"

namespace pellicle {
namespace {

constexpr double kTiny = 1e-12;
constexpr double kMaxElongation = 20.0;  // truth meshes of longer shapes would not fit their triangle budget
constexpr double kTorusBlend = 0.25;     // of the minor radius: the groove between the two tubes stays resolvable
constexpr double kMinTorusRatio = 1.4;   // the blend narrows the holes by up to a quarter of the minor radius

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

/// Distance to the tube's centre circle of radius `major` in the plane z = 0, whose middle is (`offset`, 0, 0).
LevelSample ring_distance(double major, double offset, const Vec3& x) {
  Vec3 in_plane(x.x() - offset, x.y(), 0.0);
  if (in_plane.norm() < kTiny) in_plane.x() = kTiny;  // on the axis every direction is as good as another
  const double rho = in_plane.norm();
  const Vec3 from_ring = in_plane * (1.0 - major / rho) + Vec3(0, 0, x.z());
  const double distance = std::max(from_ring.norm(), kTiny);
  return {distance, from_ring / distance};
}

LevelSample level_of(const TorusShape& s, const Vec3& x) {
  const LevelSample ring = ring_distance(s.major, 0.0, x);
  return {ring.value - s.minor, ring.gradient};
}

LevelSample level_of(const DoubleTorusShape& s, const Vec3& x) {
  const LevelSample a = ring_distance(s.major, s.major, x), b = ring_distance(s.major, -s.major, x);
  const double lower = std::min(a.value, b.value);
  const double exp_a = std::exp((lower - a.value) / s.blend), exp_b = std::exp((lower - b.value) / s.blend);
  const double sum = exp_a + exp_b;
  return {lower - s.minor - s.blend * std::log(sum), (exp_a * a.gradient + exp_b * b.gradient) / sum};
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

Vec3 bounds_of(const TorusShape& s) {
  return Vec3(s.major, s.major, 0) + Vec3::Constant(s.minor);
}
Vec3 bounds_of(const DoubleTorusShape& s) {
  return Vec3(2.0 * s.major, s.major, 0) + Vec3::Constant(s.minor + s.blend * std::numbers::ln2);
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

void check_radius(const std::string& name, const std::vector<double>& radius) {
  const auto refuse = [&](const std::string& rule) {
    throw SettingError("bad radius", "radius", fmt::format("{}", fmt::join(radius, ",")), rule);
  };
  const bool torus = shape_genus(name) > 0;
  const std::size_t most = torus ? 2 : (shape_has_half_axes(name) ? 3 : 1);
  const bool valid = std::all_of(radius.begin(), radius.end(), [](double r) { return std::isfinite(r) && r > 0.0; });
  if (!valid || (radius.size() != 1 && radius.size() != most)) {
    const char* takes = torus ? "one scale or MAJOR,MINOR" : (most == 3 ? "one scale or three half axes" : "one value");
    refuse(fmt::format("shape '{}' takes {}, in mm and above 0", name, takes));
  }
  const auto [shortest, longest] = std::minmax_element(radius.begin(), radius.end());
  if (*longest > kMaxElongation * *shortest) {
    refuse(fmt::format("the longest may be at most {} times the shortest", kMaxElongation));
  }
  if (radius.size() == 2 && radius[0] < kMinTorusRatio * radius[1]) {
    refuse(fmt::format("MAJOR must be at least {} times MINOR, else the hole closes", kMinTorusRatio));
  }
}

}  // namespace

const std::vector<std::string>& shape_names() {
  static const std::vector<std::string> names{"sphere",   "ellipsoid", "superquadric", "blob",        "bean",
                                              "dumbbell", "tube",      "torus",        "double-torus"};
  return names;
}

int shape_genus(const std::string& name) {
  if (name == "double-torus") return 2;
  return name == "torus" ? 1 : 0;
}

bool shape_has_half_axes(const std::string& name) {
  return name == "ellipsoid" || name == "superquadric" || name == "bean";
}

Shape make_shape(const std::string& name, const std::vector<double>& radius, double amplitude, std::uint64_t seed) {
  if (std::find(shape_names().begin(), shape_names().end(), name) == shape_names().end()) {
    throw SettingError("unknown shape", "shape", name, fmt::format("choose one of {}", fmt::join(shape_names(), ", ")));
  }
  check_radius(name, radius);
  const double r = radius[0];
  const auto axes = [&](const Vec3& ratio) {
    return radius.size() == 3 ? Vec3(radius[0], radius[1], radius[2]) : Vec3(r * ratio);
  };
  if (name == "sphere") return EllipsoidShape{Vec3::Constant(r)};
  if (name == "ellipsoid") return EllipsoidShape{axes({1.0, 1.3, 0.75})};
  if (name == "superquadric") return SuperquadricShape{axes({1.0, 1.15, 0.85})};
  if (name == "blob") return draw_blob(r, amplitude, seed);
  if (name == "bean") return BeanShape{axes({1.45, 0.85, 0.8})};
  if (name == "dumbbell") return DumbbellShape{0.8 * r, 0.9 * r, 0.28 * r};
  if (name == "tube") return TubeShape{0.5 * r, 1.1 * r, 1.25};
  const bool two = radius.size() == 2;
  if (name == "torus") return two ? TorusShape{r, radius[1]} : TorusShape{r, 0.4 * r};
  const double major = two ? r : 0.7 * r, minor = two ? radius[1] : 0.3 * r;
  return DoubleTorusShape{major, minor, kTorusBlend * minor};
}

LevelSample level(const Shape& shape, const Vec3& x) {
  return std::visit([&x](const auto& s) { return level_of(s, x); }, shape);
}

Vec3 half_bounds(const Shape& shape) {
  return std::visit([](const auto& s) { return bounds_of(s); }, shape);
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
