#include "pellicle/fit/point_fit.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "pellicle/base/errors.h"
#include "pellicle/base/interrupt.h"
#include "pellicle/base/parallel.h"
#include "pellicle/base/random.h"
#include "pellicle/energies/bending.h"
#include "pellicle/energies/geometry.h"
#include "pellicle/energies/profiles.h"
#include "pellicle/energies/springs.h"
#include "pellicle/fit/objective.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/mesh/point_tree.h"

namespace pellicle {

namespace {

constexpr int kMostPoints = 60000;     ///< springs of one step; all points are measured
constexpr double kSlidingShare = 0.0;  ///< of a spring along the surface: none, points pull along normals
constexpr double kTangential = 100.0;  ///< bending along the surface, in units of bending itself
constexpr double kHold = 0.002;        ///< weight of what holds samples at the places they were given

/// Enough samples that facets are a quarter of a control edge or less.
int sampling_level_for(const SurfaceModel& model) {
  const double wanted = std::max(1500.0, 3.9 * control_point_count(model));
  int level = 1;
  while (level < 6 && 0.5 * base_facets(model) * std::pow(4.0, level) < wanted) ++level;
  return level;
}

// A harmonic of degree l bends with l^4/2 (energies/bending.h); the finest that n control points show has l^2 = n/4.
// There bending counts a hundredth of what the data do.
double bending_weight(const SurfaceModel& model, double smoothness) {
  const double degree2 = 0.25 * control_point_count(model);
  return smoothness * 0.02 / (degree2 * degree2);
}

std::vector<Vec3> targets_at(const SampleLayout& layout, const SphereMap& map, const Mat3& map_from_reference) {
  const SphereLocator locator(map);
  std::vector<Vec3> targets;
  targets.reserve(layout.reference.size());
  int hint = -1;
  for (const Vec3& r : layout.reference) {
    const auto place = locator.locate(map_from_reference * r, hint);
    hint = place.triangle;
    targets.push_back(locator.point_at(place));
  }
  return targets;
}

/// Ellipsoid-like start: least-squares affine map from the reference shape to the targets.
Parameters affine_start(const SurfaceModel& model, const SampleLayout& layout, const std::vector<Vec3>& targets,
                        const std::vector<double>& area) {
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Matrix<double, 4, 3> right = Eigen::Matrix<double, 4, 3>::Zero();
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const Eigen::Vector4d r(layout.reference[i].x(), layout.reference[i].y(), layout.reference[i].z(), 1.0);
    normal += area[i] * r * r.transpose();
    right += area[i] * r * targets[i].transpose();
  }
  const Eigen::Matrix<double, 4, 3> solution = normal.ldlt().solve(right);
  const Mat3 A = solution.topRows<3>().transpose();
  const Vec3 centre = solution.row(3).transpose();
  // A map that folds (limbs may do that) tells no normals: then a ball of the same size.
  const double size = std::cbrt(std::abs(A.determinant()));
  const Eigen::JacobiSVD<Mat3> svd(A);
  const bool sound = A.determinant() > 0.0 && svd.singularValues()[2] > 0.05 * svd.singularValues()[0];
  return affine_image(model, centre,
                      sound ? A : Mat3(std::max(size, 0.2 * svd.singularValues()[0]) * Mat3::Identity()));
}

// Vertices of a normal-subdivision surface lie on it: points and normals are read off the targets.
void place_vertices(const NormalModel& model, const SampleLayout& layout, const std::vector<Vec3>& targets,
                    Parameters& parameters) {
  const std::vector<Vec3> area = area_vectors(layout, targets);
  for (int v = 0; v < model.vertex_count(); ++v) {
    const auto at = 6 * static_cast<std::size_t>(v);
    const Vec3 place(model.reference()[at], model.reference()[at + 1], model.reference()[at + 2]);
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < layout.reference.size(); ++i) {
      if ((layout.reference[i] - place).squaredNorm() < (layout.reference[nearest] - place).squaredNorm()) nearest = i;
    }
    const double length = area[nearest].norm();
    for (int c = 0; c < 3; ++c) {
      parameters[at + static_cast<std::size_t>(c)] = targets[nearest][c];
      if (length > 0.0) parameters[at + 3 + static_cast<std::size_t>(c)] = area[nearest][c] / length;
    }
  }
}

bool is_held_out(std::size_t point) {
  return RandomEngine(point).next() % 10 == 0;
}

class LevelFit {
 public:
  LevelFit(const Surface& start, const GeometryData& data, const PointFitSettings& settings, bool hold_out)
      : data_(data),
        settings_(settings),
        hold_out_(hold_out),
        surface_(start),
        layout_(layout_of(start.model, sampling_level_for(start.model))) {
    if (!layout_.reference.empty()) {
      operators_.push_back(grouped_operator("bending", bending_weight(start.model, settings.smoothness),
                                            bending_rows(layout_), layout_));
    }
    if (data.surface) {
      data_surface_ = std::make_unique<ClosestPoint>(*data.surface);
      for (const auto& t : data.surface->triangles) {
        const auto& v = data.surface->vertices;
        const auto at = [&](std::size_t i) { return static_cast<std::size_t>(t[i]); };
        data_normals_.push_back((v[at(1)] - v[at(0)]).cross(v[at(2)] - v[at(0)]));
      }
    }
    choose_points();
  }

  const SampleLayout& layout() const { return layout_; }

  // Least squares to one place a sample.
  void to_targets(const std::vector<Vec3>& targets) {
    const std::vector<double> area = sample_areas(layout_, targets);
    anchors_ = targets;
    surface_.parameters = affine_start(surface_.model, layout_, targets, area);
    if (const auto* normal = std::get_if<NormalModel>(&surface_.model)) {
      place_vertices(*normal, layout_, targets, surface_.parameters);
    }
    StepProblem problem{&surface_.model, &layout_, &operators_, {}, {}};
    problem.rows.push_back({"targets", target_rows(targets, area, 1.0)});
    double trust = 1e4, before = -1.0;
    for (int k = 0; k < 8; ++k) {
      check_interrupt();
      const StepOutcome outcome = solve_step(problem, Solver::least_squares, 5, trust, surface_.parameters);
      iterations_ += outcome.iterations;
      SurfaceSamples samples;
      evaluate(surface_.model, surface_.parameters, layout_, false, samples);
      const double energy = problem.rows[0].energy(samples.x);
      if (!outcome.usable || (before >= 0.0 && energy > 0.98 * before)) break;
      before = energy;
    }
  }

  // Springs, attached anew until the residual stops falling.
  void springs() {
    double best = -1.0, trust = 1e3;
    Parameters best_parameters = surface_.parameters;
    int poor = 0;
    reason_ = "step limit";
    for (int step = 0; step <= settings_.max_steps; ++step) {
      check_interrupt();
      SurfaceSamples samples;
      evaluate(surface_.model, surface_.parameters, layout_, false, samples);
      const std::vector<Attachment> at = attach(chosen_, layout_, samples);
      const std::vector<double> weights = weights_of(at);
      const double rms = weighted_rms(at, weights);
      if (best < 0.0 || rms < best) {
        poor = best >= 0.0 && rms > (1.0 - settings_.improvement) * best ? poor + 1 : 0;
        best = rms;
        best_parameters = surface_.parameters;
      } else {
        ++poor;
      }
      if (poor >= 3 || best < 1e-9 * data_.diameter) {
        reason_ = "converged";
        break;
      }
      if (step == settings_.max_steps) break;
      solve(samples, at, weights, trust);
      ++steps_;
    }
    surface_.parameters = std::move(best_parameters);
  }

  PointFit result(double seconds) {
    PointFit fit{surface_, {}};
    fit.summary.control_points = control_point_count(surface_.model);
    fit.summary.degrees_of_freedom = degrees_of_freedom(surface_.model);
    fit.summary.steps = steps_;
    fit.summary.solver_iterations = iterations_;
    fit.summary.reason = reason_;
    fit.summary.seconds = seconds;
    SurfaceSamples samples;
    evaluate(surface_.model, surface_.parameters, layout_, false, samples);
    const std::vector<Attachment> at = attach(chosen_, layout_, samples);
    fit.summary.inlier_rms = weighted_rms(at, weights_of(at));
    if (!held_out_.empty()) fit.summary.held_out_rms = held_out_rms(samples);
    return fit;
  }

 private:
  // A fixed choice of the points when there are more than a step needs, and those that take no part.
  void choose_points() {
    const std::size_t n = data_.points.size();
    const std::size_t stride = std::max<std::size_t>(1, n / kMostPoints);
    for (std::size_t k = 0; k < n; ++k) {
      if (stride > 1 && RandomEngine(k ^ 0x5bd1e995U).next() % stride != 0) continue;
      const double w = data_.weights.empty() ? 1.0 : data_.weights[k];
      if (hold_out_ && is_held_out(k)) {
        held_out_.push_back(data_.points[k]);
        continue;
      }
      chosen_.push_back(data_.points[k]);
      given_weight_.push_back(w);
      if (!data_.normals.empty()) chosen_normal_.push_back(data_.normals[k]);
      total_weight_ += w;
    }
  }

  std::vector<double> weights_of(const std::vector<Attachment>& at) const {
    std::vector<double> weights = given_weight_;
    if (data_.robust) {
      std::vector<double> distances;
      distances.reserve(at.size());
      for (const Attachment& a : at) distances.push_back(a.distance);
      const std::vector<double> sound = tukey_weights(distances, 6.0, 1e-4 * data_.diameter);
      for (std::size_t k = 0; k < weights.size(); ++k) weights[k] *= sound[k];
    }
    // A sheet's other side is no match.
    for (std::size_t k = 0; k < chosen_normal_.size(); ++k) {
      if (chosen_normal_[k].dot(at[k].normal) < 0.0) weights[k] = 0.0;
    }
    return weights;
  }

  // Points on a sheet's other side count here with their distance: a surface that collapses there does not look good.
  double weighted_rms(const std::vector<Attachment>& at, const std::vector<double>& weights) const {
    double squares = 0.0, total = 0.0;
    for (std::size_t k = 0; k < at.size(); ++k) {
      const double w = data_.robust ? weights[k] : given_weight_[k];
      squares += w * at[k].distance * at[k].distance;
      total += w;
    }
    return total > 0.0 ? std::sqrt(squares / total) : 0.0;
  }

  double held_out_rms(const SurfaceSamples& samples) const {
    std::vector<double> distances;
    distances.reserve(held_out_.size());
    for (const Attachment& a : attach(held_out_, layout_, samples)) distances.push_back(a.distance);
    const std::vector<double> weights = data_.robust ? tukey_weights(distances, 6.0, 1e-4 * data_.diameter)
                                                     : std::vector<double>(distances.size(), 1.0);
    double squares = 0.0, total = 0.0;
    for (std::size_t k = 0; k < distances.size(); ++k) {
      squares += weights[k] * distances[k] * distances[k];
      total += weights[k];
    }
    return total > 0.0 ? std::sqrt(squares / total) : 0.0;
  }

  void solve(const SurfaceSamples& samples, const std::vector<Attachment>& at, const std::vector<double>& weights,
             double& trust) {
    const std::vector<double> area = sample_areas(layout_, samples.x);
    const bool both = data_surface_ != nullptr;
    StepProblem problem{&surface_.model, &layout_, &operators_, {}, {}};
    problem.rows.push_back(
        {"springs", spring_rows(layout_, chosen_, at, weights, total_weight_, kSlidingShare, both ? 0.5 : 1.0)});
    if (both) {
      problem.rows.push_back({"reverse springs", reverse_spring_rows(samples, area, *data_surface_, data_normals_,
                                                                     0.2 * data_.diameter, 0.5)});
    }
    problem.rows.push_back(
        {"anchor", sliding_rows(anchors_.empty() ? samples.x : anchors_, samples.normal, area, kHold)});
    if (!operators_.empty() && kTangential > 0) {
      problem.rows.push_back(
          {"parameter lines", tangential_rows(operators_[0].rows, samples.normal,
                                              kTangential * operators_[0].root_weight * operators_[0].root_weight)});
    }
    const Parameters before = surface_.parameters;
    const StepOutcome outcome = solve_step(problem, Solver::least_squares, 6, trust, surface_.parameters);
    if (!outcome.usable) surface_.parameters = before;
    iterations_ += outcome.iterations;
  }

  const GeometryData& data_;
  const PointFitSettings& settings_;
  bool hold_out_;
  Surface surface_;
  SampleLayout layout_;
  std::vector<Vec3> anchors_;
  std::vector<GroupedOperator> operators_;
  std::unique_ptr<ClosestPoint> data_surface_;
  std::vector<Vec3> data_normals_, chosen_, chosen_normal_, held_out_;
  std::vector<double> given_weight_;
  double total_weight_ = 0.0;
  int steps_ = 0, iterations_ = 0;
  std::string reason_ = "as started";
};

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

Correspondence choose_axis(const SphereMap& map, const SurfaceModel& probe) {
  const SampleLayout layout = layout_of(probe, 2);
  if (layout.reference.empty()) throw BadData("fit (model): it has no reference shape to lay out; start from a solid");
  std::vector<GroupedOperator> operators;
  operators.push_back(grouped_operator("bending", bending_weight(probe, 1.0), bending_rows(layout), layout));
  Correspondence best{map, Mat3::Identity()};
  double least = -1.0;
  // Thirteen axes, towards faces, edges and corners of a cube: a code above 13 is one of these turned round.
  for (int code = 14; code < 27; ++code) {
    const int layer = code / 9, row = code / 3 % 3, column = code % 3;
    const Vec3 axis = Vec3(column - 1, row - 1, layer - 1).normalized();
    const Mat3 rotation = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), axis).toRotationMatrix();
    const std::vector<Vec3> targets = targets_at(layout, map, rotation);
    const std::vector<double> area = sample_areas(layout, targets);
    Surface surface{probe, affine_start(probe, layout, targets, area)};
    if (const auto* normal = std::get_if<NormalModel>(&probe))
      place_vertices(*normal, layout, targets, surface.parameters);
    StepProblem problem{&surface.model, &layout, &operators, {}, {}};
    problem.rows.push_back({"targets", target_rows(targets, area, 1.0)});
    double trust = 1e4;
    solve_step(problem, Solver::least_squares, 5, trust, surface.parameters);
    SurfaceSamples samples;
    evaluate(surface.model, surface.parameters, layout, false, samples);
    const double energy = problem.rows[0].energy(samples.x);
    if (std::isfinite(energy) && (least < 0.0 || energy < least)) {
      least = energy;
      best.map_from_reference = rotation;
    }
  }
  return best;
}

PointFit fit_to_map(const SurfaceModel& model, const GeometryData& data, const Correspondence& correspondence,
                    const PointFitSettings& settings, bool hold_out) {
  const auto begin = std::chrono::steady_clock::now();
  LevelFit fit({model, affine_image(model, Vec3::Zero(), Mat3::Identity())}, data, settings, hold_out);
  fit.to_targets(targets_at(fit.layout(), correspondence.map, correspondence.map_from_reference));
  fit.springs();
  return fit.result(seconds_since(begin));
}

PointFit fit_from(const Surface& start, const GeometryData& data, const PointFitSettings& settings, bool hold_out) {
  const auto begin = std::chrono::steady_clock::now();
  LevelFit fit(start, data, settings, hold_out);
  fit.springs();
  return fit.result(seconds_since(begin));
}

TriangleMesh measuring_mesh(const Surface& surface) {
  int level = 6;
  while (level > 2 && base_facets(surface.model) * std::pow(4.0, level) > 250000.0) --level;
  return tessellate(surface, level);
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
  fit.summary.self_intersections = self_intersection_count(mesh);
}

}  // namespace pellicle
