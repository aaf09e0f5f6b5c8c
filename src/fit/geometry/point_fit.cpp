#include "pellicle/fit/geometry/point_fit.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "pellicle/base/errors.h"
#include "pellicle/base/parallel.h"
#include "pellicle/energies/geometry.h"
#include "pellicle/energies/profiles.h"
#include "pellicle/fit/geometry/level_fit.h"
#include "pellicle/mesh/distance.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/mesh/points/point_tree.h"

namespace pellicle {

namespace {

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

double diameter_of(const std::vector<Vec3>& points) {
  if (points.size() < 2) return 0.0;
  constexpr int kDirections = 200;
  std::vector<Vec3> extremes(2 * kDirections);
  parallel_for(kDirections, 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const double z = (static_cast<double>(k) + 0.5) / kDirections, angle = 2.399963229728653 * static_cast<double>(k);
      const double r = std::sqrt(1.0 - z * z);
      const Vec3 d(r * std::cos(angle), r * std::sin(angle), z);
      std::size_t lo = 0, hi = 0;
      for (std::size_t i = 1; i < points.size(); ++i) {
        if (d.dot(points[i] - points[lo]) < 0.0) lo = i;
        if (d.dot(points[i] - points[hi]) > 0.0) hi = i;
      }
      extremes[2 * k] = points[lo];
      extremes[2 * k + 1] = points[hi];
    }
  });
  double largest = 0.0;
  for (std::size_t i = 0; i < extremes.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) largest = std::max(largest, (extremes[i] - extremes[j]).squaredNorm());
  }
  return std::sqrt(largest);
}

GeometryData data_of(TriangleMesh surface, int samples) {
  turn_outward(surface);
  surface.normals.clear();
  GeometryData data;
  data.robust = false;
  data.points = sample_surface(surface, samples);
  const ClosestPoint on(surface);
  for (const Vec3& x : data.points) {
    const auto& t = surface.triangles[static_cast<std::size_t>(on.query(x).triangle)];
    const auto at = [&](std::size_t i) -> const Vec3& { return surface.vertices[static_cast<std::size_t>(t[i])]; };
    data.normals.push_back((at(1) - at(0)).cross(at(2) - at(0)));
  }
  data.diameter = diameter_of(surface.vertices);
  data.surface = std::move(surface);
  return data;
}

Correspondence choose_axis(const SphereMap& map, const SurfaceModel& probe) {
  const SampleLayout layout = knot_layout_of(probe, 1);
  if (layout.reference.empty()) throw BadData("fit (model): it has no reference shape to lay out; start from a solid");
  std::vector<GroupedOperator> operators;
  operators.push_back(grouped_operator("bending", bending_weight(probe), coarse_bending(probe, layout).rows, layout));
  StepSolver solver(probe, layout, Solver::least_squares, 1e4);
  solver.set_operators(std::move(operators));
  Correspondence best{map, Mat3::Identity()};
  double least = -1.0;
  // Thirteen axes, towards faces, edges and corners of a cube: a code above 13 is one of these turned round.
  for (int code = 14; code < 27; ++code) {
    const int across = code % 3 - 1, along = code / 3 % 3 - 1, up = code / 9 - 1;
    const Vec3 axis = Vec3(across, along, up).normalized();
    const Mat3 rotation = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), axis).toRotationMatrix();
    const std::vector<Vec3> targets = targets_at(layout, map, rotation);
    Surface surface{probe, start_at_targets(probe, layout, targets)};
    solver.set_trust_radius(1e4);
    const std::vector<NamedRows> pull{{"targets", target_rows(targets, sample_areas(layout, targets), 1.0)}};
    solver.set_pulls(pull);
    solver.step(5, 0, surface.parameters);
    SurfaceSamples samples;
    evaluate(surface.model, surface.parameters, layout, false, samples);
    const double energy = pull[0].energy(samples.x);
    if (std::isfinite(energy) && (least < 0.0 || energy < least)) {
      least = energy;
      best.map_from_reference = rotation;
    }
  }
  return best;
}

PointFit fit_to_map(const SurfaceModel& model, const GeometryData& data, const Correspondence& correspondence,
                    const PointFitSettings& settings, bool hold_out, const Observer& observer) {
  const auto begin = std::chrono::steady_clock::now();
  LevelFit fit({model, affine_image(model, Vec3::Zero(), Mat3::Identity())}, data, settings, hold_out, observer);
  fit.to_targets(targets_at(fit.layout(), correspondence.map, correspondence.map_from_reference));
  fit.springs();
  fit.bound_residuals();
  return fit.result(seconds_since(begin));
}

PointFit fit_from(const Surface& start, const GeometryData& data, const PointFitSettings& settings, bool hold_out,
                  const Observer& observer) {
  const auto begin = std::chrono::steady_clock::now();
  LevelFit fit(start, data, settings, hold_out, observer);
  fit.springs();
  fit.bound_residuals();
  return fit.result(seconds_since(begin));
}

namespace {

Residual residual_of(std::vector<double> distances) {
  Residual out;
  for (const double d : distances) {
    out.rms += d * d / static_cast<double>(distances.size());
    out.max = std::max(out.max, d);
  }
  out.rms = std::sqrt(out.rms);
  out.p95 = quantile_of(std::move(distances), 0.95);
  return out;
}

template <class F>
std::vector<double> distances_of(const std::vector<Vec3>& points, const F& distance) {
  std::vector<double> out(points.size());
  parallel_for(points.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) out[i] = distance(points[i]);
  });
  return out;
}

/// See PointFitSummary::astray_share. One alone is an outlier, several together are not.
double astray_share_of(const GeometryData& data, const TriangleMesh& mesh, const ClosestPoint& to_mesh) {
  constexpr int kNeighbours = 5, kFewest = 4;
  constexpr double kNear = 4.0;  // typical distances of neighbouring points
  constexpr double kDeviations = 5.0, kLeast = 0.01;
  std::vector<Vec3> points;
  for (std::size_t k = 0; k < data.points.size(); ++k) {
    if (data.weights.empty() || data.weights[k] > 0.0) points.push_back(data.points[k]);
  }
  if (points.size() <= kNeighbours) return 0.0;
  const PointTree tree(std::move(points));
  const std::vector<Vec3>& x = tree.points();
  std::vector<double> offset(x.size());
  parallel_for(x.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto near = to_mesh.query(x[i]);
      const auto& t = mesh.triangles[static_cast<std::size_t>(near.triangle)];
      const auto at = [&](std::size_t c) -> const Vec3& { return mesh.vertices[static_cast<std::size_t>(t[c])]; };
      const Vec3 normal = (at(1) - at(0)).cross(at(2) - at(0));
      offset[i] = std::copysign(near.distance, normal.dot(x[i] - at(0)));
    }
  });
  std::vector<double> distance(offset.size());
  std::transform(offset.begin(), offset.end(), distance.begin(), [](double o) { return std::abs(o); });
  const double noise = 1.4826 * median_of(std::move(distance));
  const double far = std::max(kDeviations * noise, kLeast * data.diameter), reach = kNear * point_spacing(tree);
  std::vector<double> astray(x.size(), 0.0);
  parallel_for(x.size(), 256, [&](std::size_t begin, std::size_t end) {
    std::vector<double> others;
    for (std::size_t i = begin; i < end; ++i) {
      if (std::abs(offset[i]) < far) continue;
      others.clear();
      for (const auto& n : tree.nearest(x[i], kNeighbours + 1)) {
        if (n.point != static_cast<int>(i) && n.distance < reach)
          others.push_back(std::copysign(1.0, offset[i]) * offset[static_cast<std::size_t>(n.point)]);
      }
      if (others.size() >= kFewest && median_of(others) >= far) astray[i] = 1.0;
    }
  });
  return sum(astray) / static_cast<double>(x.size());
}

}  // namespace

void measure_fit(const GeometryData& data, PointFit& fit) {
  const TriangleMesh mesh = measuring_mesh(fit.surface);
  const ClosestPoint to_mesh(mesh);
  std::vector<Vec3> points = data.points;
  if (data.surface) points.insert(points.end(), data.surface->vertices.begin(), data.surface->vertices.end());
  fit.summary.to_surface = residual_of(distances_of(points, [&](const Vec3& x) { return to_mesh.query(x).distance; }));
  const std::vector<Vec3> samples = sample_surface(mesh, 20000);
  if (data.surface) {
    const ClosestPoint to_data(*data.surface);
    fit.summary.to_data = residual_of(distances_of(samples, [&](const Vec3& x) { return to_data.query(x).distance; }));
  } else {
    const PointTree tree(data.points);
    fit.summary.to_data =
        residual_of(distances_of(samples, [&](const Vec3& x) { return tree.nearest(x, 1).front().distance; }));
  }
  if (data.robust && !data.surface) fit.summary.astray_share = astray_share_of(data, mesh, to_mesh);
  fit.summary.self_intersections = self_intersection_count(mesh);
  const MeshTopology topology = topology_of(mesh);
  fit.summary.genus = topology.genus;
  fit.summary.border_loops = topology.border_loops;
}

}  // namespace pellicle
