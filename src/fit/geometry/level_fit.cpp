#include "pellicle/fit/geometry/level_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "pellicle/base/parallel.h"
#include "pellicle/base/random.h"
#include "pellicle/energies/bending.h"
#include "pellicle/energies/geometry.h"
#include "pellicle/energies/rim_springs.h"
#include "pellicle/fit/geometry/measuring_mesh.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/mesh/points/point_tree.h"
#include "pellicle/solve/hold_out.h"
#include "pellicle/solve/objective.h"

namespace pellicle {

namespace {

constexpr std::size_t kMostPoints = 60000;  ///< springs of one step; all points are measured
constexpr double kTukey = 6.0;              ///< beyond this many robust deviations, points count for nothing
constexpr double kHuber = 3.0;              ///< beyond this many, points pull no harder
constexpr double kLeastDeviation = 1e-4;    ///< of the diameter: no point this near is an outlier
// Deviation that the first step trusts, and its share from step to step: limbs that the start lacks are far off, too.
constexpr double kFirstDeviation = 0.04, kDeviationShare = 0.5;
// Stiff first: limbs then move as a whole instead of crumpling.
constexpr double kFirstStiffness = 20.0, kStiffnessShare = 0.7;
constexpr double kAnchor = 0.0002;  ///< of sliding_rows, against springs of weight 1
constexpr double kRim = 1.0;        ///< of the rim's springs, against springs of weight 1
// bound_residuals: what is aimed at and what is given up at once, shares of the largest residual that was asked for; a
// point's weight at most; steps, and steps that gain nothing before the end.
constexpr double kBoundShare = 0.85, kHopeless = 3.4, kMostEmphasis = 1e4;
constexpr int kBoundSteps = 15, kPoorBoundSteps = 5;
// Springs back to the data, and what counts as beyond them, in typical distances of neighbouring points.
constexpr double kOvershoot = 1.0, kBeyond = 2.5;

/// About four samples a control point or more; see knot_layout_of.
SampleLayout fit_layout(const SurfaceModel& model) {
  int level = 1;
  while (level < 6 && control_point_count(model) * std::pow(4.0, level) < 1500.0) ++level;
  return knot_layout_of(model, level);
}

std::vector<double> distances_of(const std::vector<Attachment>& at) {
  std::vector<double> distances;
  distances.reserve(at.size());
  for (const Attachment& a : at) distances.push_back(a.distance);
  return distances;
}

}  // namespace

LevelFit::LevelFit(const Surface& start, const GeometryData& data, const PointFitSettings& settings, bool hold_out,
                   const Observer& observer)
    : data_(data),
      settings_(settings),
      observer_(observer),
      hold_out_(hold_out),
      surface_(start),
      layout_(fit_layout(start.model)),
      fine_(layout_of(start.model, measuring_level(start.model))),
      solver_(surface_.model, layout_, Solver::least_squares, 1e4) {
  stiffening_.assign(layout_.patches.size(), 1.0);
  if (!layout_.reference.empty()) bending_ = coarse_bending(start.model, layout_);
  if (data.surface) {
    data_surface_ = std::make_unique<ClosestPoint>(*data.surface);
    const auto& v = data.surface->vertices;
    for (const auto& t : data.surface->triangles) {
      const auto at = [&](std::size_t i) { return static_cast<std::size_t>(t[i]); };
      data_normals_.push_back((v[at(1)] - v[at(0)]).cross(v[at(2)] - v[at(0)]));
    }
  }
  if (!data.rim.empty() && !is_closed(start.model)) {
    rim_ = std::make_unique<RimLocator>(data.rim);
    border_ = border_loops(layout_.triangles);
  }
  choose_points();
  if (data.robust && !data.surface && data.rim.empty()) take_cloud();
}

void LevelFit::take_cloud() {
  std::vector<Vec3> points;
  for (std::size_t k = 0; k < chosen_.size(); ++k) {
    if (given_weight_[k] > 0.0) points.push_back(chosen_[k]);
  }
  if (points.empty()) return;
  cloud_ = std::make_unique<PointTree>(std::move(points));
  reach_ = kBeyond * point_spacing(*cloud_);
}

// A fixed choice of the points when there are more than a step needs, and those that take no part.
void LevelFit::choose_points() {
  const std::size_t n = data_.points.size();
  const auto wanted = static_cast<std::size_t>(std::max(8000, 12 * control_point_count(surface_.model)));
  const std::size_t stride = std::max<std::size_t>(1, n / std::min(kMostPoints, wanted));
  for (std::size_t k = 0; k < n; ++k) {
    if (stride > 1 && RandomEngine(k ^ 0x5bd1e995U).next() % stride != 0) continue;
    const double given = data_.weights.empty() ? 1.0 : data_.weights[k];
    if (hold_out_ && is_held_out(k, 10)) {
      held_out_.push_back(data_.points[k]);
      held_out_weight_.push_back(given);
      continue;
    }
    chosen_.push_back(data_.points[k]);
    given_weight_.push_back(given);
    if (!data_.normals.empty()) chosen_normal_.push_back(data_.normals[k]);
    total_weight_ += given_weight_.back();
  }
}

std::vector<double> LevelFit::weights_of(const std::vector<Attachment>& at) const {
  std::vector<double> weights = given_weight_;
  if (data_.robust) {
    const double floor = deviation_ * data_.diameter;
    const std::vector<double> sound =
        grows() ? huber_weights(distances_of(at), kHuber, floor) : tukey_weights(distances_of(at), kTukey, floor);
    for (std::size_t k = 0; k < weights.size(); ++k) weights[k] *= sound[k];
  }
  for (std::size_t k = 0; k < emphasis_.size(); ++k) weights[k] *= emphasis_[k];
  // The other side of a sheet does not match.
  for (std::size_t k = 0; k < chosen_normal_.size(); ++k) {
    if (chosen_normal_[k].dot(at[k].normal) < 0.0) weights[k] = 0.0;
  }
  return weights;
}

// Points near a sheet's wrong side count with their distance: a surface that collapses there must not look good. Nor
// must one that gives up a limb, hence Huber's weights.
double LevelFit::rms_of(const std::vector<Attachment>& at, const std::vector<double>& given) const {
  std::vector<double> weights = given;
  if (data_.robust) {
    const std::vector<double> sound = huber_weights(distances_of(at), kHuber, kLeastDeviation * data_.diameter);
    for (std::size_t k = 0; k < weights.size(); ++k) weights[k] *= sound[k];
  }
  double squares = 0.0;
  for (std::size_t k = 0; k < at.size(); ++k) squares += weights[k] * at[k].distance * at[k].distance;
  const double total = sum(given);
  return total > 0.0 ? std::sqrt(squares / total) : 0.0;
}

// Bending with the weight of this model times `factor`, and more where it would fold.
void LevelFit::set_bending(double factor) {
  std::vector<GroupedOperator> operators;
  if (bending_.rows.size() > 0) {
    VectorRows rows = bending_.rows;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const auto begin = static_cast<std::size_t>(rows.start[r]), end = static_cast<std::size_t>(rows.start[r + 1]);
      const auto patch = layout_.patch_of[static_cast<std::size_t>(rows.sample[begin])];
      const double stiffening = std::sqrt(stiffening_[static_cast<std::size_t>(patch)]);
      for (std::size_t k = begin; k < end; ++k) rows.coefficient[k] *= stiffening;
    }
    operators.push_back(grouped_operator("bending", factor * settings_.smoothness * bending_weight(surface_.model),
                                         std::move(rows), layout_));
  }
  solver_.set_operators(std::move(operators));
}

StepOutcome LevelFit::solve(std::vector<NamedRows> rows) {
  Parameters before = surface_.parameters;
  solver_.set_pulls(std::move(rows));
  StepOutcome outcome = solver_.step(6, 0, surface_.parameters);
  if (!outcome.usable) surface_.parameters = std::move(before);
  iterations_ += outcome.iterations;
  return outcome;
}

// The stiffer, the more it is the ellipsoid that never cuts itself: as stiff as it takes at first, and then as loose as
// asked for, held back where it would begin to cut itself.
void LevelFit::to_targets(const std::vector<Vec3>& targets) {
  constexpr double kStiffest = 1e8, kRatio = 10.0;
  anchors_ = targets;
  surface_.parameters = start_at_targets(surface_.model, layout_, targets);
  const std::vector<NamedRows> pull{{"targets", target_rows(targets, sample_areas(layout_, targets), 1.0)}};
  const auto pulled = [&](double factor) {
    observer_.check_stopped();
    set_bending(factor);
    for (int k = 0; k < (solver_.has_closed_form() ? 1 : 3); ++k) {
      if (!solve(pull).usable) break;
    }
  };
  double factor = 1.0 / kRatio;
  do {
    factor *= kRatio;
    pulled(factor);
    cut_ = cuts_of(surface_.parameters).pairs > 0;
  } while (cut_ && factor < kStiffest && !solver_.operators().empty());
  while (!cut_ && factor > 1.0) {
    factor /= kRatio;
    const Parameters before = surface_.parameters;
    pulled(factor);
    hold_back(before);
  }
}

void LevelFit::step() {
  observer_.check_stopped();
  const SampledSurface now(layout_, surface_);
  const std::vector<Attachment> at = attach(chosen_, now);
  const double half = data_surface_ ? 0.5 : 1.0;  // springs and reverse springs count the same
  std::vector<NamedRows> rows;
  rows.push_back({"springs", spring_rows(layout_, chosen_, at, weights_of(at), total_weight_, 0.0, half)});
  if (data_surface_) {
    rows.push_back(
        {"reverse springs", reverse_spring_rows(now, *data_surface_, data_normals_, 0.2 * data_.diameter, half)});
  }
  if (cloud_ && grows()) {
    rows.push_back({"overshoot", overshoot_rows(now, *cloud_, reach_, kOvershoot)});
  }
  const std::vector<Vec3>& anchors = anchors_.empty() ? now.x() : anchors_;
  rows.push_back({"anchor", sliding_rows(now, anchors, kAnchor)});
  if (rim_) {
    rows.push_back({"rim springs", rim_spring_rows(border_, now, *rim_, 0.2 * data_.diameter, kRim)});
  }
  const Parameters before = surface_.parameters;
  solve(std::move(rows));
  if (!cut_) hold_back(before);
  ++steps_;
}

// Steps until the residual stops falling. The best of all, the start left aside, is kept.
void LevelFit::springs() {
  double stiffness = data_.robust && grows() ? kFirstStiffness : 1.0;
  set_bending(stiffness);
  if (anchors_.empty()) cut_ = cuts_of(surface_.parameters).pairs > 0;
  double best = -1.0;
  Parameters best_parameters;
  int poor = 0;
  reason_ = "step limit";
  if (data_.robust) deviation_ = kFirstDeviation;
  for (int k = 0; k < settings_.max_steps; ++k) {
    step();
    const double before = stiffness;
    stiffness = std::max(1.0, kStiffnessShare * stiffness);
    if (stiffen_folds() || stiffness < before) set_bending(stiffness);
    if (deviation_ > kLeastDeviation) {
      deviation_ = std::max(kLeastDeviation, kDeviationShare * deviation_);
      continue;
    }
    const double here = rms_of(attach(chosen_, SampledSurface(layout_, surface_)), given_weight_);
    poor = best < 0.0 || here < (1.0 - settings_.improvement) * best ? 0 : poor + 1;
    if (best < 0.0 || here < best) {
      best = here;
      best_parameters = surface_.parameters;
    }
    if (poor >= 2) {
      reason_ = "converged";
      break;
    }
  }
  if (best >= 0.0) surface_.parameters = std::move(best_parameters);
}

// Multipliers of the constraints d <= bound: what stays beyond it gains weight with each step, until the other points
// give way. All data are looked at, and what lies beyond is chosen as well; the bound is a little below what was asked
// for, because that is measured on other facets.
void LevelFit::bound_residuals() {
  if (!settings_.largest_residual || data_.robust) return;
  const double bound = kBoundShare * *settings_.largest_residual;
  std::vector<Vec3> all = data_.points;
  if (data_.surface) all.insert(all.end(), data_.surface->vertices.begin(), data_.surface->vertices.end());
  std::vector<int> place(all.size(), -1);  // among the chosen
  const auto look = [&] { return distances_of(attach(all, SampledSurface(layout_, surface_))); };
  const auto largest = [](const std::vector<double>& of) { return *std::max_element(of.begin(), of.end()); };
  std::vector<double> distance = look();
  double least = largest(distance);
  if (least > kHopeless * *settings_.largest_residual) return;
  Parameters best = surface_.parameters;
  const std::size_t chosen_before = chosen_.size();
  emphasis_.assign(chosen_before, 1.0);
  for (int k = 0, poor = 0; k < kBoundSteps && poor < kPoorBoundSteps && least > bound; ++k) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (distance[i] > bound && place[i] < 0) {
        place[i] = static_cast<int>(chosen_.size());
        choose(all[i]);
      }
      if (place[i] < 0) continue;
      double& emphasis = emphasis_[static_cast<std::size_t>(place[i])];
      const double beyond = std::max(1.0, distance[i] / bound);
      emphasis = std::min(kMostEmphasis, emphasis * beyond * beyond);
    }
    step();
    distance = look();
    const double here = largest(distance);
    ++poor;
    if (here >= least) continue;
    poor = 0;
    least = here;
    best = surface_.parameters;
  }
  surface_.parameters = std::move(best);
  emphasis_.clear();
  chosen_.resize(chosen_before);
  given_weight_.resize(chosen_before);
  if (!chosen_normal_.empty()) chosen_normal_.resize(chosen_before);
}

// One more point, of those that a surface bounds.
void LevelFit::choose(const Vec3& x) {
  chosen_.push_back(x);
  given_weight_.push_back(1.0);
  emphasis_.push_back(1.0);
  if (chosen_normal_.empty()) return;
  const int triangle = data_surface_ ? data_surface_->query(x).triangle : -1;
  chosen_normal_.push_back(triangle < 0 ? Vec3::Zero() : data_normals_[static_cast<std::size_t>(triangle)]);
}

PointFit LevelFit::result(double seconds) const {
  PointFit fit{surface_, {}};
  fit.summary.control_points = control_point_count(surface_.model);
  fit.summary.degrees_of_freedom = degrees_of_freedom(surface_.model);
  fit.summary.steps = steps_;
  fit.summary.solver_iterations = iterations_;
  fit.summary.reason = reason_;
  fit.summary.seconds = seconds;
  const SampledSurface now(layout_, surface_);
  fit.summary.inlier_rms = rms_of(attach(chosen_, now), given_weight_);
  if (!held_out_.empty()) fit.summary.held_out_rms = rms_of(attach(held_out_, now), held_out_weight_);
  return fit;
}

}  // namespace pellicle
