#include "pellicle/fit/fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pellicle/base/errors.h"
#include "pellicle/fit/evidence.h"
#include "pellicle/fit/expert_points.h"
#include "pellicle/fit/hypotheses.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/raster/rasterize.h"

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
  double credit = 0.0;                        ///< evidence, weighed by the seed's size: what hypotheses are compared by
  std::optional<PointDistances> points = {};  ///< of the expert points, when there are any
};

void run_stages(const StageContext& context, std::size_t from, std::size_t to, Trial& trial) {
  for (std::size_t s = from; s < to && trial.state.status == FitStatus::ok; ++s) {
    trial.stages.push_back(run_stage(context, trial.hypothesis.stages[s], trial.state));
  }
}

// No reading found an edge: the seed itself is handed back, with its status.
FitResult nothing_seen(const Seed& seed, const FitSettings& settings) {
  const auto* sphere = std::get_if<SeedSphere>(&seed);
  const SurfaceModel model = start_model(settings.model);
  FitResult result{sphere != nullptr
                       ? Surface{model, on_ellipsoid(model, sphere->center, sphere->radius * Mat3::Identity())}
                       : std::get<Surface>(seed),
                   {}};
  result.summary.reason = "no edge in a quarter of the directions around the seed";
  return result;
}

bool looks_like_membrane(const FitSettings& settings, const Trial& trial) {
  return settings.boundary == Boundary::automatic && !trial.state.reading.ridge && !trial.state.reading.tissue &&
         trial.evidence.returning_share > 0.5;
}

void judge(const StageContext& context, Trial& trial) {
  trial.evidence = evidence_of(context.image, trial.state.surface, trial.state.reading.ridge, context.geometry);
  trial.volume = volume_with_normals(tessellate(trial.state.surface, 3));
  trial.credit = trial.evidence.score;
  // What lies behind the edge is like the object again: the near side of a membrane, unless a step was asked for.
  if (looks_like_membrane(context.settings, trial) && trial.credit > 0.0) trial.credit *= 0.25;
  // A seed says where the object is and, roughly, how large. Half the credit at three times its radius or a third of
  // it.
  const double radius = std::cbrt(3.0 * std::abs(trial.volume) / (4.0 * std::numbers::pi));
  if (trial.hypothesis.seed_radius > 0.0 && trial.credit > 0.0) {
    const double ratio = radius / (3.0 * trial.hypothesis.seed_radius),
                 inverse = trial.hypothesis.seed_radius / (3.0 * radius);
    trial.credit /= 1.0 + std::pow(ratio, 4) + std::pow(inverse, 4);
  }
  // Points say where the surface is: half the credit where they lie a tenth of the radius off.
  if (!context.settings.points.points.empty()) {
    trial.points = distances_to(context.settings.points, trial.state.surface, context.image.grid.mean_spacing());
    if (trial.credit > 0.0) trial.credit /= 1.0 + std::pow(trial.points->rms_mm / (0.1 * radius), 2);
  }
}

// By how much the best reading must be ahead of one that found another volume. Among ranges of "alike the seed" the
// evidence of a wrong one was seen 1.4 times that of the right one (a tumour in T1), so more is asked there.
constexpr double kMargin = 1.1, kAlikeMargin = 1.5;
// A result that shares less with its ball seed is likely another object beside it. (Of 40 hippocampi from a ball of 5
// mm those of Dice below 0.05 share 6 to 31 %, the others 43 % or more but for one.)
constexpr double kLeastSeedShare = 0.25;

bool still_moves(const Trial& trial) {
  if (trial.stages.empty()) return false;
  const StageSummary& last = trial.stages.back();
  return last.reason.starts_with("step limit") && last.last_move_mm > 0.5;
}

// Of a ball that is where the object was said to be and of the surface that was found.
double shared_volume(const SeedSphere& ball, const Surface& surface) {
  constexpr int kAcross = 24;
  ImageGrid grid;
  grid.size = {kAcross, kAcross, kAcross};
  grid.spacing = Vec3::Constant(2.0 * ball.radius / kAcross);
  grid.origin_in_world = ball.center - Vec3::Constant(ball.radius) + 0.5 * grid.spacing;
  const Image<std::uint8_t> mask = rasterize_mask(tessellate(surface, 3), grid);
  const double radius = 0.5 * kAcross, middle = radius - 0.5;
  int shared = 0;
  for (int k = 0; k < kAcross; ++k) {
    for (int j = 0; j < kAcross; ++j) {
      for (int i = 0; i < kAcross; ++i) {
        const bool in_ball = (Vec3(i, j, k) - Vec3::Constant(middle)).norm() <= radius;
        shared += in_ball && mask.voxels[grid.offset(i, j, k)] != 0 ? 1 : 0;
      }
    }
  }
  return shared * grid.spacing.prod();
}

double seed_share(const SeedSphere& ball, const Trial& trial) {
  const double of_ball = 4.0 / 3.0 * std::numbers::pi * std::pow(ball.radius, 3);
  const double smaller = std::min(of_ball, std::abs(trial.volume));
  return smaller > 0.0 ? std::min(1.0, shared_volume(ball, trial.state.surface) / smaller) : 0.0;
}

// A fit that ran well is still held against the image. Thresholds: recipes measured on phantoms, CT and MR
// (docs/accuracy.md).
void check_evidence(const Trial& trial, FitSummary& summary) {
  const Evidence& e = trial.evidence;
  const bool tissue = trial.state.reading.tissue.has_value();
  if (still_moves(trial)) {
    summary.status = FitStatus::not_converged;
    summary.reason =
        fmt::format("still moving by {:.2f} mm a step at the step limit", trial.stages.back().last_move_mm);
  } else if (e.contrast <= 0.0 || (!tissue && e.score < 0.1)) {
    summary.status = FitStatus::no_contrast;
    summary.reason =
        fmt::format("no evidence of an edge along a quarter of the surface (evidence {:.2f}, 0.3 is wanted)", e.score);
  } else if (e.weak_share > 0.25 || (!tissue && e.score < 0.3)) {
    summary.status = FitStatus::doubtful;
    summary.reason = fmt::format("weak evidence: {:.2f} (0.3 is wanted), {:.0f} % of the surface without an edge",
                                 e.score, 100.0 * e.weak_share);
  } else if (summary.seed_share && *summary.seed_share < kLeastSeedShare) {
    summary.status = FitStatus::doubtful;
    summary.reason = fmt::format("the surface left its seed: they share {:.0f} % of the smaller one's volume",
                                 100.0 * *summary.seed_share);
  } else if (summary.margin > 0.0 && summary.margin < (trial.state.reading.similarity ? kAlikeMargin : kMargin)) {
    summary.status = FitStatus::ambiguous;
    summary.reason = fmt::format(
        "another reading of another size has nearly the same evidence (margin {:.2f}); give a seed or settings",
        summary.margin);
  }
}

// Whether something can be left out of it and foretold: edges, or, where no stage has edges, expert points.
bool measures(const Stage& stage, const std::vector<Stage>& stages) {
  const auto uses = [](const Stage& s, const char* name) {
    const auto at = s.energies.find(name);
    return at != s.energies.end() && at->second > 0.0;
  };
  const bool edges = std::any_of(stages.begin(), stages.end(), [&](const Stage& s) { return uses(s, "edge"); });
  return uses(stage, edges ? "edge" : "springs");
}

// Where expert points that were left out are foretold better without the image (edges of another polarity, or of
// another object), it has no say.
void without_image(const StageContext& context, Trial& trial, FitState& best, Stage& last) {
  const auto edge = last.energies.find("edge");
  if (best.held_out_points < 0.0 || edge == last.energies.end() || !(edge->second > 0.0)) return;
  Stage alone = last;
  alone.name = "points alone";
  alone.energies["edge"] = 0.0;
  FitState state = trial.hypothesis.start;
  state.hold_out = true;
  StageSummary summary = run_stage(context, alone, state);
  const bool better = state.status == FitStatus::ok && state.held_out_points < 0.9 * best.held_out_points;
  if (!better) summary.reason += "; dropped: points left out are foretold better with the image";
  trial.stages.push_back(summary);
  if (!better) return;
  best = std::move(state);
  last = std::move(alone);
}

// The remaining stages of the chosen reading. Edge stages leave a quarter of the samples out; more control points, and
// then more or less smoothness, are kept only if they foretell the samples left out better. Last, all samples are used.
void refine_by_evidence(const StageContext& context, Trial& trial) {
  const auto& stages = trial.hypothesis.stages;
  const std::size_t first_new = trial.hypothesis.compare_after;
  FitState best = trial.state;
  const Stage* best_stage = nullptr;
  constexpr double kGain = 0.99;   // less than one per cent better is not better
  constexpr double kNoise = 0.05;  // of neighbouring residuals
  for (std::size_t s = first_new; s < stages.size() && trial.state.status == FitStatus::ok; ++s) {
    if (best_stage != nullptr && best.residual_correlation < kNoise && !context.settings.error_target_mm) {
      trial.stages.back().reason += "; what is left is noise";
      break;
    }
    trial.state.hold_out = true;
    trial.stages.push_back(run_stage(context, stages[s], trial.state));
    if (!measures(stages[s], stages)) continue;
    const bool failed = trial.state.status != FitStatus::ok;
    // Told how good is good enough, finer control meshes are taken until it is.
    const std::optional<double>& target = context.settings.error_target_mm;
    if (target && !failed) {
      best = trial.state;
      best_stage = &stages[s];
      if (!(trial.state.error <= *target)) continue;
      trial.stages.back().reason += "; the error target is met";
      break;
    }
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
    for (const double factor : {3.0, 1.0 / 3.0}) {
      bool improved = false;
      for (int round = 0; round < 4; ++round) {
        Stage trial_stage = last;
        trial_stage.max_steps = 5;
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
  without_image(context, trial, best, last);
  trial.state = best;
  trial.state.hold_out = false;
  trial.state.all_samples = true;
  last.name = "all samples";
  trial.stages.push_back(run_stage(context, last, trial.state));
}

bool better(const Trial& a, const Trial& b) {
  const bool a_ok = a.state.status == FitStatus::ok, b_ok = b.state.status == FitStatus::ok;
  return a_ok != b_ok ? a_ok : a.credit > b.credit;
}

// Levels that were told, or evidence far beyond what any leak was ever seen to have: other readings need no look.
bool is_decisive(const Trial& trial) {
  // Of a ladder of ranges every rung is tried: too narrow a range has good evidence too where there is little noise.
  if (trial.state.status != FitStatus::ok || trial.state.reading.similarity) return false;
  return trial.hypothesis.certain || (trial.credit > 0.25 && trial.evidence.score > 3.0 &&
                                      trial.evidence.weak_share < 0.05 && trial.evidence.returning_share < 0.5);
}

// How much better the best is than the best of those that found another volume (by more than a fifth).
double margin_of(const std::vector<Trial>& trials, std::size_t best) {
  double runner_up = -1.0;
  bool found = false;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const double ratio = trials[i].volume / trials[best].volume;
    if (i == best || trials[i].state.status != FitStatus::ok || (ratio > 0.8 && ratio < 1.25)) continue;
    runner_up = std::max(runner_up, trials[i].credit);
    found = true;
  }
  if (!found) return -1.0;
  return runner_up > 0.0 ? std::min(1e3, trials[best].credit / runner_up) : 1e3;
}

FitResult summarise(const std::vector<Trial>& trials, std::size_t best, double margin) {
  const Trial& chosen = trials[best];
  FitResult result{chosen.state.surface, {}, chosen.state.trace};
  FitSummary& summary = result.summary;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const Trial& t = trials[i];
    summary.hypotheses.push_back({t.state.reading.name, t.state.status, t.evidence.score, 1e-3 * t.volume, i == best});
  }
  summary.margin = margin;
  summary.status = chosen.state.status;
  summary.reason = chosen.state.reason;
  summary.stages = chosen.stages;
  summary.evidence = chosen.evidence;
  const Reading& reading = chosen.state.reading;
  summary.boundary = reading.ridge ? Boundary::ridge : Boundary::step;
  summary.polarity = reading.similarity ? Polarity::automatic : reading.sign > 0.0 ? Polarity::bright : Polarity::dark;
  summary.level_inside = chosen.state.levels.inside;
  summary.level_outside = chosen.state.levels.outside;
  summary.points = chosen.points;
  if (chosen.hypothesis.ball && chosen.state.status == FitStatus::ok) {
    summary.seed_share = seed_share(*chosen.hypothesis.ball, chosen);
  }
  if (summary.status == FitStatus::ok) check_evidence(chosen, summary);
  return result;
}

// A seed surface that the image leads to nowhere is kept: the fit fails, comes to no rest, sees no edge, or weak ones
// and weaker than where it began.
std::optional<Trial> seed_as_given(const StageContext& context, const std::vector<Seed>& seeds, const Trial& refined) {
  const auto* surface = std::get_if<Surface>(&seeds.front());
  if (seeds.size() > 1 || surface == nullptr || refined.hypothesis.certain) return std::nullopt;
  FitSummary alone;
  alone.status = refined.state.status;
  if (alone.status == FitStatus::ok) check_evidence(refined, alone);
  if (alone.status == FitStatus::ok) return std::nullopt;
  Trial given{refined.hypothesis, refined.hypothesis.start, {}, {}};
  given.state.surface = *surface;
  given.state.reading.name = "seed surface, as given";
  judge(context, given);
  if (alone.status == FitStatus::doubtful && refined.credit >= given.credit) return std::nullopt;
  return given;
}

}  // namespace

FitResult fit_surface(const Image<float>& image, const std::vector<Seed>& seeds, const FitSettings& settings,
                      const Progress& progress) {
  settings.validate();
  for (const Seed& seed : seeds) {
    const auto* surface = std::get_if<Surface>(&seed);
    if (surface == nullptr || is_closed(surface->model)) continue;
    throw UsageError(fmt::format("seed surface ({}): is open and encloses no object; start from a closed one",
                                 model_name(surface->model)));
  }
  GeometryCache geometry;
  const StageContext context{image, settings, geometry};
  const auto prefix = [&](std::size_t s) { return seeds.size() > 1 ? fmt::format("seed {}: ", s + 1) : std::string(); };
  std::vector<Trial> trials;
  std::size_t best = 0;
  const auto decided = [&] { return !trials.empty() && is_decisive(trials[best]); };
  const auto try_all = [&](std::vector<Hypothesis> hypotheses) {
    for (Hypothesis& h : hypotheses) {
      if (decided()) return;
      if (progress)
        progress(0.5 * static_cast<double>(trials.size()) / (static_cast<double>(trials.size()) + 3.0),
                 h.start.reading.name);
      const FitState start = h.start;
      trials.push_back({std::move(h), start, {}, {}});
      run_stages(context, 0, trials.back().hypothesis.compare_after, trials.back());
      judge(context, trials.back());
      if (better(trials.back(), trials[best])) best = trials.size() - 1;
    }
  };
  for (std::size_t s = 0; s < seeds.size() && !decided(); ++s) {
    try_all(hypotheses_for(image, seeds[s], settings, prefix(s)));
  }
  const bool alike =
      settings.similarity && settings.start_rule == StartRule::automatic && settings.boundary != Boundary::ridge;
  for (std::size_t s = 0; s < seeds.size() && alike && !decided(); ++s) {
    const auto* sphere = std::get_if<SeedSphere>(&seeds[s]);
    if (sphere != nullptr) try_all(similarity_hypotheses(image, *sphere, settings, prefix(s)));
  }
  if (trials.empty()) return nothing_seen(seeds.front(), settings);
  if (progress) progress(0.5, "refining " + trials[best].state.reading.name);
  // Like is compared with like, before the best is refined; should refining take its lead away, that counts as well.
  const double lead = margin_of(trials, best);
  refine_by_evidence(context, trials[best]);
  judge(context, trials[best]);
  const double refined_lead = margin_of(trials, best);
  const double margin = lead < 0.0 || refined_lead < 0.0 ? std::max(lead, refined_lead) : std::min(lead, refined_lead);
  if (std::optional<Trial> given = seed_as_given(context, seeds, trials[best])) {
    const std::string failure = summarise(trials, best, margin).summary.reason;
    trials.push_back(std::move(*given));
    FitResult result = summarise(trials, trials.size() - 1, margin_of(trials, trials.size() - 1));
    result.summary.status = FitStatus::doubtful;
    result.summary.reason = "the seed is kept, the image leads it nowhere: " + failure;
    return result;
  }
  return summarise(trials, best, margin);
}

}  // namespace pellicle
