#include "pellicle/fit/refinement.h"

#include <fmt/format.h>

#include <algorithm>

namespace pellicle {

namespace {

constexpr double kGain = 0.99;       // of the held-out rms: less than one per cent better is not better
constexpr double kPointsGain = 0.9;  // of the held-out points, to go without the image
constexpr double kNoise = 0.05;      // correlation of neighbouring residuals
constexpr double kSmoothnessStep = 3.0;
constexpr int kSmoothnessRounds = 4;

// Whether something can be left out of the stage and predicted: edges, or, where no stage has edges, expert points.
bool measures(const Stage& stage, const std::vector<Stage>& stages) {
  const bool edges = std::any_of(stages.begin(), stages.end(),
                                 [](const Stage& s) { return s.energies.uses(&EnergyTraits::localises); });
  return stage.energies.uses(edges ? &EnergyTraits::localises : &EnergyTraits::needs_points);
}

const char* kNotPredicted = "dropped: held-out samples are not predicted better";

}  // namespace

std::optional<Refined> choose_detail(SurfaceFit& fit, Attempt& attempt) {
  const std::vector<Stage>& stages = attempt.now.line.stages;
  const std::optional<double>& target = fit.options().error_target_mm;
  std::optional<Refined> best;
  for (std::size_t s = attempt.now.line.compare_after; s < stages.size() && attempt.now.status == FitStatus::ok; ++s) {
    if (best && best->outcome.residual_correlation < kNoise && !target) {
      attempt.stages.back().note = "what is left is noise";
      break;
    }
    const StageOutcome outcome = fit.advance(attempt.now, {.stage = stages[s], .hold_out = true});
    attempt.stages.push_back(outcome.summary);
    if (!measures(stages[s], stages)) continue;
    const bool failed = attempt.now.status != FitStatus::ok;
    // With an error target finer control meshes are taken until it is met.
    if (target && !failed) {
      best = Refined{attempt.now, outcome, stages[s]};
      if (!(outcome.error <= *target)) continue;
      attempt.stages.back().note = "the error target is met";
      break;
    }
    if (best && (failed || !(outcome.held_out_rms < kGain * best->outcome.held_out_rms))) {
      attempt.stages.back().note = kNotPredicted;
      break;
    }
    best = Refined{attempt.now, outcome, stages[s]};
  }
  return best;
}

void choose_smoothness(SurfaceFit& fit, Attempt& attempt, Refined& best) {
  const EnergyKind* smooth = best.stage.energies.with(&EnergyTraits::smooths);
  if (smooth == nullptr) return;
  const int steps = fit.plan(StartKind::ball).smoothness_steps;
  for (const double factor : {kSmoothnessStep, 1.0 / kSmoothnessStep}) {
    bool improved = false;
    for (int round = 0; round < kSmoothnessRounds; ++round) {
      Stage stage = best.stage;
      stage.max_steps = steps;
      stage.energies[*smooth] *= factor;
      stage.name = fmt::format("smoothness {:.0e}", stage.energies[*smooth]);
      Candidate candidate = best.candidate;
      StageOutcome outcome = fit.advance(candidate, {.stage = stage, .hold_out = true});
      const bool better = candidate.status == FitStatus::ok && outcome.held_out_rms < best.outcome.held_out_rms;
      if (!better) outcome.summary.note = kNotPredicted;
      attempt.stages.push_back(outcome.summary);
      if (!better) break;
      best.candidate = std::move(candidate);
      best.outcome = std::move(outcome);
      best.stage.energies[*smooth] *= factor;
      improved = true;
    }
    if (improved) break;
  }
}

void choose_image_or_points(SurfaceFit& fit, Attempt& attempt, Refined& best) {
  if (best.outcome.held_out_points < 0.0 || !best.stage.energies.uses(&EnergyTraits::localises)) return;
  Stage alone = best.stage;
  alone.name = "points alone";
  alone.energies[*alone.energies.with(&EnergyTraits::localises)] = 0.0;
  Candidate candidate = attempt.start;
  StageOutcome outcome =
      fit.advance(candidate, {.stage = alone, .first_reach_mm = candidate.first_reach_mm, .hold_out = true});
  const bool better =
      candidate.status == FitStatus::ok && outcome.held_out_points < kPointsGain * best.outcome.held_out_points;
  if (!better) outcome.summary.note = "dropped: held-out points are predicted better with the image";
  attempt.stages.push_back(outcome.summary);
  if (better) best = {std::move(candidate), std::move(outcome), std::move(alone)};
}

namespace {

void run_policies(SurfaceFit& fit, Attempt& attempt) {
  std::optional<Refined> best = choose_detail(fit, attempt);
  if (!best) return;  // no stage measures anything: what they led to stands
  attempt.now = best->candidate;
  if (attempt.now.status != FitStatus::ok) return;
  choose_smoothness(fit, attempt, *best);
  choose_image_or_points(fit, attempt, *best);
  attempt.now = std::move(best->candidate);
  best->stage.name = "all samples";
  attempt.last = {.stage = best->stage, .all_samples = true};
  attempt.stages.push_back(fit.advance(attempt.now, attempt.last).summary);
}

}  // namespace

void refine_by_prediction(SurfaceFit& fit, Attempt& attempt) {
  run_policies(fit, attempt);
  attempt.judgement = fit.judge(attempt.now);
}

}  // namespace pellicle
