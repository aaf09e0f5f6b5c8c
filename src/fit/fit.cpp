#include "pellicle/fit/fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pellicle/fit/evidence.h"
#include "pellicle/fit/hypotheses.h"
#include "pellicle/mesh/measure.h"

namespace pellicle {

std::string to_string(FitStatus status) {
  switch (status) {
    case FitStatus::ok:
      return "ok";
    case FitStatus::doubtful:
      return "doubtful";
    case FitStatus::ambiguous:
      return "ambiguous";
    case FitStatus::not_converged:
      return "not_converged";
    case FitStatus::no_contrast:
      return "no_contrast";
    case FitStatus::leaked:
      return "leaked";
    case FitStatus::collapsed:
      return "collapsed";
    case FitStatus::folded:
      return "folded";
    case FitStatus::inside_out:
      return "inside_out";
    case FitStatus::left_image:
      return "left_image";
  }
  return "unknown";
}

int FitSummary::iterations() const {
  int total = 0;
  for (const auto& stage : stages) total += stage.solver_iterations;
  return total;
}

namespace {

struct Trial {
  Hypothesis hypothesis;
  FitState state;
  std::vector<StageSummary> stages;
  Evidence evidence;
  double volume = 0.0;
};

void run_stages(const StageContext& context, std::size_t from, std::size_t to, Trial& trial) {
  for (std::size_t s = from; s < to && trial.state.status == FitStatus::ok; ++s) {
    trial.stages.push_back(run_stage(context, trial.hypothesis.stages[s], trial.state));
  }
}

// No reading found an edge: the seed itself is handed back, with its status.
FitResult nothing_seen(const Seed& seed, const FitSettings& settings) {
  const auto* sphere = std::get_if<SeedSphere>(&seed);
  const NormalModel model = NormalModel::start(settings.start_solid, settings.rule);
  FitResult result{sphere != nullptr
                       ? Surface{model, affine_sphere(model, sphere->center, sphere->radius * Mat3::Identity())}
                       : std::get<Surface>(seed),
                   {}};
  result.summary.reason = "no edge in a quarter of the directions around the seed";
  return result;
}

void judge(const StageContext& context, Trial& trial) {
  trial.evidence = evidence_of(context.image, trial.state.surface, trial.state.reading.ridge, context.geometry);
  trial.volume = volume_with_normals(tessellate(trial.state.surface, 3));
}

bool measures_edges(const Stage& stage) {
  const auto at = stage.energies.find("edge");
  return at != stage.energies.end() && at->second > 0.0;
}

// The remaining stages of the chosen reading. Edge stages leave a quarter of the samples out; more control points, and
// then more or less smoothness, are kept only if they foretell the samples left out better. Last, all samples are used.
void refine_by_evidence(const StageContext& context, Trial& trial) {
  const auto& stages = trial.hypothesis.stages;
  const std::size_t first_new = trial.hypothesis.compare_after;
  FitState best = trial.state;
  const Stage* best_stage = nullptr;
  constexpr double kGain = 0.99;  // less than one per cent better is not better
  for (std::size_t s = first_new; s < stages.size() && trial.state.status == FitStatus::ok; ++s) {
    trial.state.hold_out = true;
    trial.stages.push_back(run_stage(context, stages[s], trial.state));
    if (!measures_edges(stages[s])) continue;
    const bool failed = trial.state.status != FitStatus::ok;
    if (best_stage != nullptr && (failed || !(trial.state.held_out_rms < kGain * best.held_out_rms))) {
      trial.stages.back().reason += "; dropped: samples left out are not foretold better";
      break;
    }
    best = trial.state;
    best_stage = &stages[s];
  }
  trial.state = best;
  if (best_stage == nullptr || trial.state.status != FitStatus::ok) return;
  Stage last = *best_stage;
  if (last.energies.contains("bending")) {
    for (const double factor : {10.0, 0.1}) {
      bool improved = false;
      for (int round = 0; round < 2; ++round) {
        Stage trial_stage = last;
        trial_stage.energies["bending"] *= factor;
        trial_stage.name = fmt::format("smoothness {:.0e}", trial_stage.energies["bending"]);
        FitState state = best;
        state.hold_out = true;
        StageSummary summary = run_stage(context, trial_stage, state);
        const bool better = state.status == FitStatus::ok && state.held_out_rms < best.held_out_rms;
        if (!better) summary.reason += "; dropped: samples left out are not foretold better";
        trial.stages.push_back(summary);
        if (!better) break;
        best = state;
        last.energies["bending"] *= factor;
        improved = true;
      }
      if (improved) break;
    }
  }
  trial.state = best;
  trial.state.hold_out = false;
  last.name = "all samples";
  trial.stages.push_back(run_stage(context, last, trial.state));
}

}  // namespace

FitResult fit_surface(const Image<float>& image, const std::vector<Seed>& seeds, const FitSettings& settings,
                      const Progress& progress) {
  settings.validate();
  GeometryCache geometry;
  const StageContext context{image, settings, geometry};
  std::vector<Trial> trials;
  for (std::size_t s = 0; s < seeds.size(); ++s) {
    const std::string prefix = seeds.size() > 1 ? fmt::format("seed {}: ", s + 1) : "";
    for (Hypothesis& h : hypotheses_for(image, seeds[s], settings, prefix)) {
      const FitState start = h.start;
      trials.push_back({std::move(h), start, {}, {}, 0.0});
    }
  }
  for (Trial& trial : trials) {
    run_stages(context, 0, trial.hypothesis.compare_after, trial);
    judge(context, trial);
  }
  if (trials.empty()) return nothing_seen(seeds.front(), settings);
  const auto better = [](const Trial& a, const Trial& b) {
    const bool fa = a.state.status == FitStatus::ok, fb = b.state.status == FitStatus::ok;
    return fa != fb ? fa : a.evidence.score > b.evidence.score;
  };
  Trial* best = &trials.front();
  for (Trial& trial : trials) {
    if (better(trial, *best)) best = &trial;
  }
  if (progress) progress(0.5, "refining");
  refine_by_evidence(context, *best);
  judge(context, *best);
  FitResult result{best->state.surface, {}};
  for (const Trial& trial : trials) {
    result.summary.hypotheses.push_back(
        {trial.state.reading.name, trial.state.status, trial.evidence.score, 1e-3 * trial.volume, &trial == best});
  }
  result.summary.status = best->state.status;
  result.summary.reason = best->state.reason;
  result.summary.stages = best->stages;
  result.summary.evidence = best->evidence;
  result.summary.level_inside = best->state.levels.inside;
  result.summary.level_outside = best->state.levels.outside;
  return result;
}

}  // namespace pellicle
