#include "pellicle/surface/morph.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>
#include <utility>

#include "pellicle/base/errors.h"
#include "pellicle/surface/spline/spline_gram.h"

namespace pellicle {
namespace {

/// sin(part * angle) / sin(angle), and its limit for a small angle.
double arc_weight(double angle, double part) {
  return angle < 1e-6 ? part : std::sin(part * angle) / std::sin(angle);
}

/// A unit vector orthogonal to the unit vector n, the same for n and -n.
Vec3 across(const Vec3& n) {
  Eigen::Index least = 0;
  n.cwiseAbs().minCoeff(&least);
  const Vec3 axis = Vec3::Unit(least);
  return (axis - axis.dot(n) * n).normalized();
}

/// Along the great circle from a to b, beyond it for tau outside [0, 1]; opposite normals take a way of their own.
Vec3 turned(const Vec3& a, const Vec3& b, double tau) {
  const double angle = 2.0 * std::atan2((a - b).norm(), (a + b).norm());
  if (std::numbers::pi - angle < 1e-6) {
    const double half = 0.5 * std::numbers::pi;
    return tau < 0.5 ? turned(a, across(a), angle / half * tau) : turned(b, across(a), angle / half * (1.0 - tau));
  }
  return (arc_weight(angle, 1.0 - tau) * a + arc_weight(angle, tau) * b).normalized();
}

std::vector<double> areas_by_sample(const SampleLayout& layout, const std::vector<Vec3>& x) {
  std::vector<double> areas(x.size(), 0.0);
  for (const auto& t : layout.triangles) {
    const double area = (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]).norm() / 6.0;
    for (const int v : t) areas[v] += area;
  }
  return areas;
}

std::vector<Vec3> samples_of(const SurfaceModel& model, const Parameters& parameters, const SampleLayout& layout) {
  SurfaceSamples samples;
  evaluate(model, parameters, layout, false, samples);
  return std::move(samples.x);
}

/// At least some thousand samples: the inner product is then exact to about 1e-4.
int measuring_level(const SurfaceModel& model) {
  int level = 1;
  while (level < 6 && (base_facets(model) << (2 * level)) < 8000) ++level;
  return level;
}

std::string describe(const Surface& surface) {
  return fmt::format("a '{}' surface of {} control points", model_name(surface.model),
                     control_point_count(surface.model));
}

[[noreturn]] void refuse(const Surface& a, const Surface& b, const std::string& hint) {
  throw UsageError(fmt::format("shapes do not match (A and B): A is {}, B {}; {}", describe(a), describe(b), hint));
}

/// Whether one control mesh, and the rule that makes a surface of it, serves both.
bool same_kind(const NormalModel& a, const NormalModel& b) {
  return a.rule() == b.rule();
}
bool same_kind(const SplineModel& a, const SplineModel& b) {
  return a.settings().topology == b.settings().topology && a.settings().generator == b.settings().generator;
}
template <class A, class B>
bool same_kind(const A&, const B&) {
  return std::is_same_v<A, B>;
}

template <class A, class B>
bool same_mesh(const A&, const B&) {
  return false;
}
bool same_mesh(const NormalModel& a, const NormalModel& b) {
  return a.triangles() == b.triangles();
}
bool same_mesh(const SplineModel& a, const SplineModel& b) {
  return a.settings().m1 == b.settings().m1 && a.settings().m2 == b.settings().m2;
}
bool same_mesh(const CatmullClarkModel& a, const CatmullClarkModel& b) {
  return a.topology().quads == b.topology().quads;
}
bool same_mesh(const SlimeModel& a, const SlimeModel& b) {
  return a.topology().quads == b.topology().quads;
}

bool same_kind(const Surface& a, const Surface& b) {
  return std::visit([](const auto& m, const auto& n) { return same_kind(m, n); }, a.model, b.model);
}

bool same_control_mesh(const Surface& a, const Surface& b) {
  return std::visit([](const auto& m, const auto& n) { return same_mesh(m, n); }, a.model, b.model);
}

/// Splines: with at least so many control points each way.
bool enlarge(Surface& surface, const SplineSettings& least) {
  const auto& model = std::get<SplineModel>(surface.model);
  const int m1 = std::max(model.settings().m1, least.m1), m2 = std::max(model.settings().m2, least.m2);
  if (m1 == model.settings().m1 && m2 == model.settings().m2) return false;
  auto [larger, parameters] = model.resampled(surface.parameters, m1, m2);
  surface = {std::move(larger), std::move(parameters)};
  return true;
}

using Blocks = Eigen::Matrix<double, Eigen::Dynamic, 3>;

/// A shape less its mean, of size 1: one row per block. Only points move with a shape, vectors do not.
Blocks centred_blocks(const SurfaceModel& model, const Eigen::MatrixXd& gram, const Parameters& parameters, Vec3& mean,
                      double& size) {
  const std::vector<BlockKind> kinds = blocks_of(model);
  const auto count = static_cast<Eigen::Index>(kinds.size());
  Eigen::VectorXd one(count);  // the constant 1 as a spline
  for (Eigen::Index i = 0; i < count; ++i) one[i] = kinds[static_cast<std::size_t>(i)] == BlockKind::point ? 1.0 : 0.0;
  Blocks blocks =
      Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>>(parameters.data(), count, 3);
  const Eigen::VectorXd weights = gram * one;
  mean = blocks.transpose() * weights / weights.dot(one);
  blocks -= one * mean.transpose();
  size = std::sqrt(blocks.cwiseProduct(gram * blocks).sum());
  return blocks / size;
}

double angle_of(double apart, double together) {  // exact for small angles too
  return 2.0 * std::atan2(std::sqrt(apart), std::sqrt(together));
}

ShapeMoments moments_by_gram(const SurfaceModel& model, const Eigen::MatrixXd& gram, const Parameters& a,
                             const Parameters& b) {
  ShapeMoments moments;
  const Blocks x = centred_blocks(model, gram, a, moments.mean_a, moments.size_a);
  const Blocks y = centred_blocks(model, gram, b, moments.mean_b, moments.size_b);
  const auto square = [&gram](const Blocks& v) { return std::max(0.0, v.cwiseProduct(gram * v).sum()); };
  moments.angle = angle_of(square(x - y), square(x + y));
  return moments;
}

/// The parameters of shape `p` with every point and vector put through `f(block, kind)`.
template <class F>
Parameters combined(const MorphPath& path, const F& f) {
  Parameters result(path.a.size());
  std::size_t at = 0;
  for (const BlockKind kind : blocks_of(path.model)) {
    const Vec3 a(&path.a[at]), b(&path.b[at]);
    const Vec3 value = f(kind, a, b);
    std::copy_n(value.data(), 3, &result[at]);
    at += 3;
  }
  return result;
}

Parameters on_plane(const MorphPath& path, double tau) {
  return combined(path, [tau](BlockKind kind, const Vec3& a, const Vec3& b) -> Vec3 {
    return kind == BlockKind::unit_normal ? turned(a, b, tau) : Vec3((1.0 - tau) * a + tau * b);
  });
}

Parameters on_sphere(const MorphPath& path, double tau) {
  const ShapeMoments& m = path.moments;
  const double of_a = arc_weight(m.angle, 1.0 - tau) / m.size_a, of_b = arc_weight(m.angle, tau) / m.size_b;
  Parameters shape = combined(path, [&](BlockKind kind, const Vec3& a, const Vec3& b) -> Vec3 {
    switch (kind) {
      case BlockKind::unit_normal:
        return turned(a, b, tau);
      case BlockKind::vector:
        return of_a * a + of_b * b;
      case BlockKind::point:
        break;
    }
    return of_a * (a - m.mean_a) + of_b * (b - m.mean_b);
  });
  const ShapeMoments now = shape_moments(path.model, path.measure, shape, shape);
  const double size = std::pow(m.size_a, 1.0 - tau) * std::pow(m.size_b, tau) / now.size_a;
  const Vec3 mean = (1.0 - tau) * m.mean_a + tau * m.mean_b;
  double* block = shape.data();
  for (const BlockKind kind : blocks_of(path.model)) {
    Eigen::Map<Vec3> v(block);
    if (kind == BlockKind::point) v = (mean + size * (v - now.mean_a)).eval();
    if (kind == BlockKind::vector) v *= size;
    block += 3;
  }
  return shape;
}

}  // namespace

MatchedSurfaces match_surfaces(const Surface& a, const Surface& b) {
  if (!same_kind(a, b)) refuse(a, b, "choose two of one kind, fitted with the same `model` and `rule`");
  MatchedSurfaces result{a, b};
  if (const auto* spline = std::get_if<SplineModel>(&a.model)) {
    const SplineSettings of_a = spline->settings(), of_b = std::get<SplineModel>(b.model).settings();
    result.a_changed = enlarge(result.a, of_b);
    result.b_changed = enlarge(result.b, of_a);
    return result;
  }
  const int points_a = control_point_count(a.model), points_b = control_point_count(b.model);
  Surface& coarse = points_a < points_b ? result.a : result.b;
  while (control_point_count(coarse.model) < std::max(points_a, points_b)) coarse = refine(coarse);
  (points_a < points_b ? result.a_changed : result.b_changed) = points_a != points_b;
  if (!same_control_mesh(result.a, result.b)) {
    refuse(a, b,
           "no refinement of one gives the control mesh of the other; fit both with the same `start`, or one from the "
           "other with `seed-model`");
  }
  return result;
}

ShapeMeasure shape_measure(const MatchedSurfaces& surfaces) {
  ShapeMeasure measure;
  if (const auto* spline = std::get_if<SplineModel>(&surfaces.a.model)) {
    measure.gram = gram_matrix(*spline);
    return measure;
  }
  measure.layout = layout_of(surfaces.a.model, measuring_level(surfaces.a.model));
  measure.weights.assign(measure.layout.patch_of.size(), 0.0);
  for (const Surface* surface : {&surfaces.a, &surfaces.b}) {
    const SampleLayout layout = layout_of(surface->model, measure.layout.level);
    const std::vector<double> areas = areas_by_sample(
        layout, layout.reference.empty() ? samples_of(surface->model, surface->parameters, layout) : layout.reference);
    double total = 0.0;
    for (const double area : areas) total += area;
    for (std::size_t i = 0; i < areas.size(); ++i) measure.weights[i] += 0.5 * areas[i] / total;
  }
  return measure;
}

ShapeMoments shape_moments(const SurfaceModel& model, const ShapeMeasure& measure, const Parameters& a,
                           const Parameters& b) {
  if (measure.gram.size() > 0) return moments_by_gram(model, measure.gram, a, b);
  std::vector<Vec3> x = samples_of(model, a, measure.layout), y = samples_of(model, b, measure.layout);
  const auto centre = [&measure](std::vector<Vec3>& points, Vec3& mean, double& size) {
    for (std::size_t i = 0; i < points.size(); ++i) mean += measure.weights[i] * points[i];
    double sum = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      points[i] -= mean;
      sum += measure.weights[i] * points[i].squaredNorm();
    }
    size = std::sqrt(sum);
    for (Vec3& p : points) p /= size;
  };
  ShapeMoments moments;
  centre(x, moments.mean_a, moments.size_a);
  centre(y, moments.mean_b, moments.size_b);
  double apart = 0.0, together = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    apart += measure.weights[i] * (x[i] - y[i]).squaredNorm();
    together += measure.weights[i] * (x[i] + y[i]).squaredNorm();
  }
  moments.angle = angle_of(apart, together);
  return moments;
}

MorphPath morph_path(const MatchedSurfaces& surfaces, MorphSpace space) {
  MorphPath path{space, surfaces.a.model, surfaces.a.parameters, surfaces.b.parameters, shape_measure(surfaces), {}};
  path.moments = shape_moments(path.model, path.measure, path.a, path.b);
  const ShapeMoments& m = path.moments;
  constexpr double kRounding = 1e-12;
  if (!std::isfinite(m.angle) || !(m.size_a > kRounding * m.mean_a.norm()) ||
      !(m.size_b > kRounding * m.mean_b.norm())) {
    throw BadData("no shape (A or B): its surface is a single point; choose another model");
  }
  if (space == MorphSpace::sphere && std::numbers::pi - m.angle < 1e-6) {
    throw BadData("opposite shapes (A and B): no great circle is the shortest between them; use `space` plane");
  }
  return path;
}

Surface surface_at(const MorphPath& path, double tau) {
  if (tau == 0.0) return {path.model, path.a};
  if (tau == 1.0) return {path.model, path.b};
  return {path.model, path.space == MorphSpace::plane ? on_plane(path, tau) : on_sphere(path, tau)};
}

}  // namespace pellicle
