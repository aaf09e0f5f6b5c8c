#include "pellicle/fit/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pellicle/energies/energy_kinds.h"
#include "pellicle/solve/dynamics.h"

namespace pellicle {

namespace {

// How many steps are a limit is said for a surface that follows its forces at once; one that moves with mass and
// damping is slower. Who writes stages for a moving surface counts its steps.
int step_limit(const Stage& stage, bool counts_own_steps, const FitOptions& options) {
  if (options.max_iterations) return *options.max_iterations;
  if (stage.solver != Solver::dynamic || counts_own_steps) return stage.max_steps;
  return static_cast<int>(std::ceil(delay(stage.motion) * stage.max_steps));
}

// What the options say of all stages.
std::vector<Stage> resolved(std::vector<Stage> stages, const FitOptions& options, bool with_points) {
  const bool typed = !options.stages.empty();
  for (Stage& stage : stages) {
    const bool counts_own_steps = typed && stage.solver == Solver::dynamic;
    stage.solver = options.solver.value_or(stage.solver);
    stage.motion = motion_of(stage.motion, options);
    stage.max_steps = step_limit(stage, counts_own_steps, options);
    stage.tolerance = options.tolerance.value_or(stage.tolerance);
    if (options.smoothing_mm) stage.smoothing_mm = options.smoothing_mm;
    if (options.detail) stage.detail = std::min(stage.detail, *options.detail);
    if (with_points && !stage.energies.contains(energy::springs)) stage.energies[energy::springs] = 1.0;
  }
  for (const auto& [kind, weight] : options.energies) {
    const bool used =
        std::any_of(stages.begin(), stages.end(), [&, k = kind](const Stage& s) { return s.energies.contains(*k); });
    for (Stage& stage : stages) {
      if (!used || stage.energies.contains(*kind)) stage.energies[*kind] = weight;
    }
  }
  if (options.target_volume_ml) {
    for (Stage& stage : stages) {
      if (!stage.energies.contains(energy::volume)) stage.energies[energy::volume] = options.volume_weight;
      stage.target_volume = 1000.0 * *options.target_volume_ml;
    }
  }
  return stages;
}

std::vector<Stage> default_stages(StartRule rule) {
  std::vector<Stage> stages;
  if (rule == StartRule::head) {
    const double bending[] = {2e-3, 2e-4, 5e-6};
    const int steps[] = {60, 40, 30};
    for (int d = 1; d <= 3; ++d) {
      stages.push_back(
          {.name = fmt::format("crossing {}", d),
           .detail = d,
           .energies = {{energy::crossing, 1.0}, {energy::bending, bending[d - 1]}, {energy::spacing, 0.3}},
           .resolution = 1.0,
           .smoothing = 0.5,
           .reach = 5.0,
           .max_steps = steps[d - 1],
           .tolerance = 0.05});
    }
    return stages;
  }
  const auto region = [](std::string name, int detail, double bending, int steps) {
    return Stage{.name = std::move(name),
                 .detail = detail,
                 .energies = {{energy::region, 1.0}, {energy::bending, bending}, {energy::spacing, 0.05}},
                 .resolution = 0.0,
                 .smoothing = 1.0,
                 .reach = 5.0,
                 .max_steps = steps,
                 .tolerance = 0.05};
  };
  const auto edge = [](std::string name, int detail, double bending) {
    return Stage{.name = std::move(name),
                 .detail = detail,
                 .energies = {{energy::edge, 1.0}, {energy::bending, bending}, {energy::spacing, 0.05}},
                 .resolution = 1.0,
                 .smoothing = 0.0,
                 .reach = 4.0,
                 .max_steps = 15,
                 .tolerance = 0.01};
  };
  return {region("coarse", 1, 2e-3, 12), region("region", 2, 2e-4, 8), edge("edge", 2, 2e-5),
          region("region fine", 3, 2e-5, 6), edge("edge fine", 3, 2e-5)};
}

std::vector<Stage> similar_stages() {
  constexpr double kBending = 1e-3;
  const auto stage = [&](std::string name, int detail, const EnergyKind& force) {
    return Stage{.name = std::move(name),
                 .detail = detail,
                 .energies = {{force, 1.0}, {energy::bending, kBending}, {energy::spacing, 0.05}},
                 .resolution = 1.0};
  };
  Stage coarse = stage("coarse", 1, energy::region), region = stage("region", 2, energy::region),
        edge = stage("edge", 2, energy::edge);
  coarse.reach = region.reach = 5.0;
  region.max_steps = 8;
  edge.smoothing = 0.0;
  edge.max_steps = 6;
  edge.tolerance = 0.01;
  // The chosen range goes on as other hypotheses do: samples are left out, and more control points are kept only if
  // they predict these better.
  Stage fine = edge;
  fine.name = "edge fine";
  fine.detail = 3;
  return {coarse, region, edge, edge, fine};
}

// Hypotheses are compared after the region stages of the first two levels of detail: far enough to tell a leak from an
// object, cheap enough to do for each.
std::size_t comparison_point(const std::vector<Stage>& stages) {
  std::size_t at = 0;
  while (at < stages.size() && at < 2 && stages[at].energies.with(&EnergyTraits::localises) == nullptr) ++at;
  return std::max<std::size_t>(1, at);
}

std::vector<Stage> stages_for_many() {
  return {{.name = "body",
           .detail = 0,
           .energies = {{energy::body, 1.0}, {energy::bending, 4e-4}},
           .resolution = 1.0,
           .smoothing = 0.0,
           .max_steps = 9,
           .tolerance = 0.0,
           .solver = Solver::dynamic,
           .motion = {1.0, 0.0, 0.04}}};
}

// A surface that is near the object is refined by edge stages alone: the wide searches that find an object from a ball
// would only lead away from it. It is compared after the first, which then runs again with samples left out.
PlanLine near_line(PlanLine line) {
  std::erase_if(line.stages,
                [](const Stage& stage) { return stage.energies.with(&EnergyTraits::searches) != nullptr; });
  line.stages.insert(line.stages.begin(), line.stages.front());
  line.compare_after = 1;
  return line;
}

std::vector<Stage> outline_stages(const FitOptions& options) {
  const double bending[] = {2e-3, 1e-3, 2e-4};
  std::vector<Stage> stages;
  for (int d = 0; d <= std::min(options.detail.value_or(2), 2); ++d) {
    stages.push_back({.name = "points",
                      .detail = d,
                      .energies = {{energy::springs, 1.0}, {energy::bending, bending[d]}, {energy::spacing, 0.05}},
                      .smoothing = 0.0,
                      .max_steps = 15,
                      .tolerance = 0.02});
  }
  return stages;
}

}  // namespace

bool may_start_at_points(const FitOptions& options) {
  if (options.start_rule != StartRule::automatic || !options.stages.empty()) return false;
  return !options.energies.contains(energy::springs) || options.energies.of(energy::springs) > 0.0;
}

FitPlan plan_for(const FitOptions& options, StartKind start, bool with_points) {
  FitPlan plan{.start = start};
  plan.error_target_mm = options.error_target_mm;
  plan.trace_every = options.trace_every;
  const bool typed = !options.stages.empty(), head = options.start_rule == StartRule::head;
  if (start == StartKind::many) {
    FitOptions own = options;
    own.smoothing_mm.reset();  // the pieces of the image are smoothed before
    plan.first.stages = resolved(typed ? options.stages : stages_for_many(), own, with_points);
    plan.first.compare_after = plan.first.stages.size();
    return plan;
  }
  PlanLine& first = plan.first;
  first.stages = resolved(typed ? options.stages : default_stages(options.start_rule), options, with_points);
  first.compare_after = comparison_point(first.stages);
  Stage trial = first.stages.back();
  trial.max_steps = plan.smoothness_steps;
  plan.smoothness_steps = step_limit(trial, typed, options);
  if (head || (typed && start != StartKind::ball)) {
    plan.certain = true;
    first.compare_after = first.stages.size();
    return plan;
  }
  if (start == StartKind::ball) {
    if (options.similarity && options.start_rule == StartRule::automatic && options.boundary != Boundary::ridge) {
      FitOptions own = options;
      own.stages.clear();
      plan.similar = PlanLine{resolved(similar_stages(), own, with_points), 3};
    }
    return plan;
  }
  // The points say where the object is, and a membrane is not searched for widely: no other hypothesis.
  plan.near = true;
  plan.certain = start == StartKind::outlined || options.boundary == Boundary::ridge;
  if (!plan.certain) plan.around = first;
  first = near_line(std::move(first));
  if (start == StartKind::outlined) plan.outline = outline_stages(options);
  return plan;
}

}  // namespace pellicle
