#include "pellicle/fit/stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "pellicle/base/parallel.h"
#include "pellicle/energies/energy_kinds.h"
#include "pellicle/energies/region.h"
#include "pellicle/energies/term.h"
#include "pellicle/solve/dynamics.h"
#include "pellicle/solve/hold_out.h"
#include "pellicle/solve/step_solver.h"

namespace pellicle {

namespace {

/// Targets of samples that lie further from the outline than the limit allows get no weight.
void keep_within(const SearchLimit& limit, const SampleView& surface, NormalTargets& targets) {
  parallel_for(targets.weight.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (!limit.outline.is_within(surface.x[i], limit.length)) targets.weight[i] = 0.0;
    }
  });
}

/// The same without what the motion adds.
std::map<std::string, double> energies_of_surface(const StepSolver& solver, const std::vector<Vec3>& x) {
  std::map<std::string, double> energies = solver.energies(x);
  energies.erase("motion");
  return energies;
}

double mean_normal_move(const SampledSurface& from, const SampledSurface& to) {
  double move = 0.0;
  for (std::size_t i = 0; i < from.area().size(); ++i) {
    move += from.area()[i] / from.total_area() * std::abs(from.normal()[i].dot(to.x()[i] - from.x()[i]));
  }
  return move;
}

class StageRun {
 public:
  StageRun(const StageContext& context, const StageRequest& request, Candidate& candidate)
      : context_(context),
        request_(request),
        stage_(request.stage),
        weights_(request.stage.energies),
        state_(candidate),
        h_in_(context.image.grid.mean_spacing()) {}

  StageOutcome run();

 private:
  struct Term {
    const EnergyKind* kind;
    double weight;
    int turn;
    EnergyTerm ask;
  };

  double area_now() const;
  void prepare();
  void make_terms();
  void make_solver(const SampledSurface& g);
  void keep_frame(int step, bool last);
  SampledSurface sampled() const { return {geometry_->layout, state_.surface, &geometry_->graph, geometry_->coarse}; }
  void ask_terms(const SampledSurface& g, int step);
  void take(const Term& term, const SampleView& surface, NormalTargets targets);
  void take(const Term& term, const SampleView& surface, PointTargets targets);
  void measure(const Term& term, const SampleView& surface, NormalTargets& targets);
  bool healthy(const SampledSurface& g);
  bool failed(FitStatus status, const std::string& reason) {
    state_.status = status;
    state_.reason = reason;
    return false;
  }
  bool at_rest(const StepOutcome& outcome, double move);
  void advance(int step);

  const StageContext& context_;
  const StageRequest& request_;
  const Stage& stage_;
  const EnergyWeights weights_;
  Candidate& state_;
  StageOutcome out_;
  double h_in_, h_ = 1.0, smoothing_mm_ = 0.0, reach_ = 0.0, first_contrast_ = 0.0, rms_ = -1.0;
  double delay_ = 1.0;  ///< by how much slower a surface with mass and damping follows (dynamics.h); else 1
  double tolerance_mm_ = 0.0;
  int max_steps_ = 0, resting_ = 0;
  bool searching_ = false, ended_ = false;
  double held_out_energy_ = 0.0;  ///< mm^2, weighted, of the samples left out
  PointDistances points_ = {};
  const StageGeometry* geometry_ = nullptr;
  std::vector<Term> terms_;
  std::optional<StepSolver> solver_;
  std::optional<WorkingImage> image_;
  std::vector<NamedRows> rows_;        ///< of the step
  std::vector<ScalarEnergy> scalars_;  ///< of the step
  std::optional<SampledSurface> now_;
  std::vector<Vec3> before_;  ///< samples a time step ago
};

double StageRun::area_now() const {
  return SampledSurface(context_.geometry.get(state_.surface.model, 2).layout, state_.surface).total_area();
}

void StageRun::prepare() {
  while (state_.detail < stage_.detail) {
    state_.surface = refine(state_.surface);
    ++state_.detail;
  }
  const double area = area_now();
  const double radius = std::sqrt(area / (4.0 * std::numbers::pi));
  // A stage that does not need every voxel works on voxels of a fifteenth of the object's radius.
  const double resolution = stage_.resolution > 0.0 ? stage_.resolution : std::max(1.0, radius / (15.0 * h_in_));
  h_ = WorkingImage(context_.image, state_.reading, resolution, 0.0, 0.0).h();
  smoothing_mm_ = stage_.smoothing_mm.value_or(stage_.smoothing * h_);
  reach_ = request_.first_reach_mm > 0.0 ? std::max(request_.first_reach_mm, stage_.reach * h_)
                                         : std::max(stage_.reach * h_, 0.15 * radius);
  for (const auto& [kind, weight] : weights_) {
    if (weight > 0.0) reach_ = std::max(reach_, kind->least_reach_mm);
  }
  image_.emplace(context_.image, state_.reading, resolution, smoothing_mm_, reach_ + 8.0 * h_);
  const Density density = request_.all_samples                      ? Density::all
                          : weights_.uses(&EnergyTraits::localises) ? Density::fine
                                                                    : Density::coarse;
  geometry_ = &context_.geometry.get(state_.surface.model, sampling_level(state_.surface.model, area, h_, density));
  first_contrast_ = state_.levels.contrast();
  // Local levels belong to the samples of the stage that measured them.
  state_.levels.local_inside.clear();
  state_.levels.local_outside.clear();
  make_terms();
}

void StageRun::make_terms() {
  for (const auto& [kind, weight] : weights_) {
    if (weight == 0.0 || kind->constant != nullptr) continue;
    const bool integral = stage_.solver == Solver::gradient && kind->as_integral.make != nullptr;
    const EnergyForm& form = integral ? kind->as_integral : kind->form;
    terms_.push_back({kind, weight, form.turn, form.make()});
  }
  std::stable_sort(terms_.begin(), terms_.end(), [](const Term& a, const Term& b) { return a.turn < b.turn; });
}

void StageRun::make_solver(const SampledSurface& g) {
  std::vector<GroupedOperator> operators;
  for (const auto& [kind, weight] : weights_) {
    if (weight == 0.0 || kind->constant == nullptr) continue;
    operators.push_back(
        grouped_operator(std::string(kind->name), weight, geometry_->constant_rows(*kind), geometry_->layout));
  }
  if (stage_.solver == Solver::dynamic) {
    delay_ = delay(stage_.motion);
    operators.push_back(motion_operator(stage_.motion, g.area(), g.x(), geometry_->layout));
  }
  solver_.emplace(state_.surface.model, geometry_->layout, stage_.solver, 1e3);
  solver_->set_operators(std::move(operators));
}

void StageRun::keep_frame(int step, bool last) {
  const int every = request_.trace_every;
  if (every <= 0 || (step % every != 0 && !last)) return;
  state_.trace.push_back({stage_.name, step, state_.surface});
}

void StageRun::ask_terms(const SampledSurface& g, int step) {
  StepView view{.surface = g.view(),
                .hypothesis = state_.reading,
                .levels = state_.levels,
                .image = &image_->image(),
                .image_version = image_->version(),
                .first_contrast = first_contrast_,
                .h = h_,
                .smoothing_mm = smoothing_mm_,
                .reach_mm = reach_,
                .step = step,
                .steps = max_steps_,
                .delay = delay_,
                .continued = request_.continued,
                .detail = state_.detail,
                .points = &context_.points,
                .one_of_many = state_.one_of_many};
  view.target_volume = stage_.target_volume;
  if (stage_.solver == Solver::gradient && !state_.reading.ridge && !state_.reading.similarity) {
    estimate_levels(view, state_.levels);
  }
  searching_ = false;
  held_out_energy_ = 0.0;
  for (Term& term : terms_) {
    view.weight = term.weight;
    view.blur_mm = state_.blur_mm;
    TermOutput answer = term.ask(view);
    if (answer.found.levels) state_.levels = std::move(*answer.found.levels);
    if (answer.found.blur_mm) state_.blur_mm = *answer.found.blur_mm;
    searching_ = searching_ || answer.found.searching;
    if (auto* targets = std::get_if<NormalTargets>(&answer.pull)) take(term, view.surface, std::move(*targets));
    if (auto* targets = std::get_if<PointTargets>(&answer.pull)) take(term, view.surface, std::move(*targets));
    if (auto* rows = std::get_if<ScalarRows>(&answer.pull)) {
      rows_.push_back({std::string(term.kind->name), std::move(*rows)});
    }
    if (auto* value = std::get_if<ScalarValue>(&answer.pull)) {
      scalars_.push_back({std::string(term.kind->name), std::move(*value)});
    }
  }
}

void StageRun::take(const Term& term, const SampleView& surface, NormalTargets targets) {
  if (term.kind->traits.localises) measure(term, surface, targets);
  rows_.push_back({std::string(term.kind->name), offset_rows(surface, targets, term.weight)});
}

// Outliers are weighed as measured, before known errors of the measurement are corrected.
void StageRun::measure(const Term& term, const SampleView& surface, NormalTargets& targets) {
  downweight_outliers(h_, targets);
  if (state_.limit) keep_within(*state_.limit, surface, targets);
  apply_correction(targets);
  const OffsetErrors errors = measure_offsets(surface, request_.hold_out, targets);
  out_.residual_correlation = errors.neighbour_correlation;
  rms_ = errors.rms;
  if (!request_.hold_out) return;
  out_.held_out_rms = errors.held_out_rms;
  if (errors.held_out_rms >= 0.0) held_out_energy_ = term.weight * errors.held_out_rms * errors.held_out_rms;
}

void StageRun::take(const Term& term, const SampleView& surface, PointTargets targets) {
  std::vector<double> distances;
  distances.reserve(targets.at.size());
  for (const Attachment& a : targets.at) distances.push_back(a.distance);
  points_ = summary_of(*targets.points, distances);
  out_.held_out_points = request_.hold_out ? hold_out_points(targets) : -1.0;
  if (out_.held_out_points >= 0.0) {
    out_.held_out_rms = std::sqrt(held_out_energy_ + term.weight * out_.held_out_points);
  }
  rows_.push_back({std::string(term.kind->name), spring_rows(surface.layout, targets, term.weight)});
}

bool StageRun::healthy(const SampledSurface& g) {
  if (!std::isfinite(g.volume()) || !std::isfinite(g.total_area()))
    return failed(FitStatus::folded, "the solver met values that are not finite");
  if (g.volume() < 0.0) return failed(FitStatus::inside_out, "the surface turned inside out");
  if (g.volume() < 4.0 * std::pow(h_in_, 3))
    return failed(FitStatus::collapsed, "the surface shrank to less than four voxels");
  if (state_.start_volume > 0.0 && g.volume() > 10.0 * state_.start_volume) {
    return failed(FitStatus::leaked, fmt::format("the surface grew to {:.0f} times the volume that the seed saw",
                                                 g.volume() / state_.start_volume));
  }
  double outside = 0.0;
  for (std::size_t i = 0; i < g.area().size(); ++i)
    outside += context_.image.grid.contains(g.x()[i]) ? 0.0 : g.area()[i];
  if (outside > 0.6 * g.total_area())
    return failed(FitStatus::left_image,
                  fmt::format("{:.0f} % of the surface lies outside the volume", 100.0 * outside / g.total_area()));
  return true;
}

// What moves with delay has further to go than it just went; what swings stands still where it turns, so that one step
// without motion is not enough.
bool StageRun::at_rest(const StepOutcome& outcome, double move) {
  resting_ = outcome.moved && delay_ * move < tolerance_mm_ ? resting_ + 1 : 0;
  return resting_ >= (stage_.solver == Solver::dynamic ? 2 : 1) && !searching_;
}

// One step; ends the stage when the surface rests or fails.
void StageRun::advance(int step) {
  StageSummary& summary = out_.summary;
  image_->cover(now_->x());
  ask_terms(*now_, step);
  solver_->set_pulls(std::exchange(rows_, {}), std::exchange(scalars_, {}));
  if (step == 0) summary.energy_before = energies_of_surface(*solver_, now_->x());
  if (stage_.solver == Solver::dynamic) aim_motion(stage_.motion, now_->x(), before_, solver_->last_operator());
  const StepOutcome outcome = solver_->step(8, 60, state_.surface.parameters);
  summary.solver_iterations += outcome.iterations;
  ++summary.steps;
  SampledSurface next = sampled();
  summary.last_move_mm = mean_normal_move(*now_, next);
  summary.history.push_back({summary.last_move_mm, energies_of_surface(*solver_, next.x())});
  before_ = now_->x();
  now_ = std::move(next);
  if (!outcome.usable || !healthy(*now_)) {
    if (state_.status == FitStatus::ok)
      failed(FitStatus::folded, "the solver found no further step: " + outcome.message);
    summary.termination = Termination::failed;
    summary.failure = state_.status;
    ended_ = true;
    return;
  }
  const bool rests = at_rest(outcome, summary.last_move_mm);
  keep_frame(step + 1, rests || step + 1 == max_steps_);
  if (rests) summary.termination = Termination::converged;
  ended_ = rests;
}

StageOutcome StageRun::run() {
  const auto begin = std::chrono::steady_clock::now();
  prepare();
  StageSummary& summary = out_.summary;
  summary.name = stage_.name;
  summary.detail = state_.detail;
  summary.control_points = control_point_count(state_.surface.model);
  summary.degrees_of_freedom = degrees_of_freedom(state_.surface.model);
  summary.samples = geometry_->layout.sample_count();
  now_ = sampled();
  make_solver(*now_);
  max_steps_ = stage_.max_steps;
  tolerance_mm_ = stage_.tolerance * h_;
  before_ = now_->x();  // every stage starts at rest
  keep_frame(0, false);
  for (int step = 0; step < max_steps_ && !ended_; ++step) {
    context_.observer.check_stopped();
    advance(step);
  }
  summary.energy_after =
      summary.history.empty() ? energies_of_surface(*solver_, now_->x()) : summary.history.back().energies;
  summary.rms_residual_mm = rms_;
  out_.error = std::max(rms_, points_.count > 0 ? points_.rms_mm : -1.0);
  summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return std::move(out_);
}

}  // namespace

StageOutcome run_stage(const StageContext& context, const StageRequest& request, Candidate& candidate) {
  return StageRun(context, request, candidate).run();
}

}  // namespace pellicle
