#include "pellicle/fit/settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pellicle/base/errors.h"
#include "pellicle/energies/energy_kinds.h"

namespace pellicle {

namespace {

void require(bool rule, const std::string& what) {
  if (!rule) throw UsageError(what);
}

void validate_energies(const EnergyWeights& energies, const std::string& where) {
  for (const auto& [kind, weight] : energies) {
    require(std::isfinite(weight),
            fmt::format("energy weight is not a finite number ({}): {}={}", where, kind->name, weight));
    require(weight >= kind->least_weight,
            fmt::format("energy weight must not be negative ({}): {}={}", where, kind->name, weight));
  }
}

void validate_motion(const Motion& motion, const std::string& where) {
  require(motion.time_step > 0.0 && std::isfinite(motion.time_step),
          fmt::format("time step must be above 0 ({}): {}", where, motion.time_step));
  require(motion.mass >= 0.0 && std::isfinite(motion.mass),
          fmt::format("mass must not be negative ({}): {}", where, motion.mass));
  require(motion.damping >= 0.0 && std::isfinite(motion.damping),
          fmt::format("damping must not be negative ({}): {}", where, motion.damping));
  require(motion.mass + motion.damping > 0.0,
          fmt::format("nothing holds the motion back ({}): mass and damping are both 0; give one of them", where));
}

Motion with_overrides(Motion motion, const FitSettings& settings) {
  motion.time_step = settings.time_step.value_or(motion.time_step);
  motion.mass = settings.mass.value_or(motion.mass);
  motion.damping = settings.damping.value_or(motion.damping);
  return motion;
}

void validate_points(const ExpertPoints& points) {
  require(
      points.weights.empty() || points.weights.size() == points.points.size(),
      fmt::format("expert points (--points): {} points and {} weights", points.points.size(), points.weights.size()));
  bool usable = points.points.empty();
  for (std::size_t k = 0; k < points.points.size(); ++k) {
    require(points.points[k].allFinite(), fmt::format("expert points (--points): point {} is not finite", k + 1));
    const double w = points.weights.empty() ? 1.0 : points.weights[k];
    require(w >= 0.0 && std::isfinite(w),
            fmt::format("expert points (--points): the weight of point {} must not be negative: {}", k + 1, w));
    usable = usable || w > 0.0;
  }
  require(usable, "expert points (--points): all weights are 0; give one above 0");
}

}  // namespace

std::vector<Stage> with_settings(std::vector<Stage> stages, const FitSettings& settings) {
  for (Stage& stage : stages) {
    stage.solver = settings.solver.value_or(stage.solver);
    stage.motion = with_overrides(stage.motion, settings);
    if (settings.detail) stage.detail = std::min(stage.detail, *settings.detail);
    if (!settings.points.points.empty() && !stage.energies.contains(energy::springs)) {
      stage.energies[energy::springs] = 1.0;
    }
  }
  for (const auto& [kind, weight] : settings.energies) {
    const bool used =
        std::any_of(stages.begin(), stages.end(), [&, k = kind](const Stage& s) { return s.energies.contains(*k); });
    for (Stage& stage : stages) {
      if (!used || stage.energies.contains(*kind)) stage.energies[*kind] = weight;
    }
  }
  return stages;
}

void Stage::validate() const {
  const std::string where = fmt::format("stage '{}'", name);
  require(detail >= 0 && detail <= 4, fmt::format("detail must be 0 to 4 ({}): {}", where, detail));
  require(resolution >= 0.0 && resolution <= 100.0,
          fmt::format("resolution must be 0 (automatic) to 100 ({}): {}", where, resolution));
  require(smoothing >= 0.0 && smoothing <= 20.0, fmt::format("smoothing must be 0 to 20 ({}): {}", where, smoothing));
  require(reach > 0.0 && reach <= 200.0, fmt::format("reach must be above 0 and at most 200 ({}): {}", where, reach));
  require(max_steps >= 0 && max_steps <= 100000,
          fmt::format("max_steps must be 0 to 100000 ({}): {}", where, max_steps));
  require(tolerance >= 0.0 && std::isfinite(tolerance),
          fmt::format("tolerance must not be negative ({}): {}", where, tolerance));
  validate_energies(energies, where);
  validate_motion(motion, where);
}

void FitSettings::validate() const {
  const SurfaceModel start = start_model(model);
  require(is_closed(start), fmt::format("surface model (--model {}): is open and encloses no object; use a closed one",
                                        model_name(start)));
  for (const Stage& stage : stages) stage.validate();
  validate_energies(energies, "--energy");
  require(!detail || (*detail >= 0 && *detail <= 4), fmt::format("--detail must be 0 to 4: {}", detail.value_or(0)));
  require(!smoothing_mm || (*smoothing_mm >= 0.0 && std::isfinite(*smoothing_mm)),
          fmt::format("--smoothing must not be negative: {}", smoothing_mm.value_or(0)));
  require(!target_volume_ml || (*target_volume_ml > 0.0 && std::isfinite(*target_volume_ml)),
          fmt::format("--target-volume must be above 0: {}", target_volume_ml.value_or(0)));
  const bool wants_volume =
      std::any_of(stages.begin(), stages.end(), [](const Stage& s) { return s.energies.contains(energy::volume); });
  validate_motion(with_overrides(Motion{}, *this), "--time-step, --mass, --damping");
  const bool moves =
      solver ? *solver == Solver::dynamic
             : std::any_of(stages.begin(), stages.end(), [](const Stage& s) { return s.solver == Solver::dynamic; });
  require(moves || !(time_step || mass || damping),
          "nothing moves (--time-step, --mass, --damping): they belong to --solver dynamic");
  require(!error_target_mm || (*error_target_mm > 0.0 && std::isfinite(*error_target_mm)),
          fmt::format("--error-target must be above 0 mm: {}", error_target_mm.value_or(0)));
  require(trace_every >= 0, fmt::format("--trace-every must not be negative: {}", trace_every));
  validate_points(points);
  const auto wants_springs = [](const EnergyWeights& weights) { return weights.uses(&EnergyTraits::needs_points); };
  const bool springs = wants_springs(energies) || std::any_of(stages.begin(), stages.end(), [&](const Stage& s) {
                         return wants_springs(s.energies);
                       });
  require(!springs || !points.points.empty(), "the energy 'springs' has no points (--energy springs): give --points");
  require(target_volume_ml || (!wants_volume && !energies.contains(energy::volume)),
          "the energy 'volume' has no target (--energy volume): give --target-volume in ml");
  require(volume_weight >= 0.0 && std::isfinite(volume_weight),
          fmt::format("--volume-weight must not be negative: {}", volume_weight));
  require(!max_iterations || *max_iterations >= 0,
          fmt::format("--max-iterations must not be negative: {}", max_iterations.value_or(0)));
  require(!tolerance || (*tolerance >= 0.0 && std::isfinite(*tolerance)),
          fmt::format("--tolerance must not be negative: {}", tolerance.value_or(0)));
}

namespace {

std::vector<Stage> stages_for_start(const FitSettings& settings) {
  std::vector<Stage> stages;
  if (settings.start_rule == StartRule::head) {
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

}  // namespace

std::vector<Stage> stages_of(const FitSettings& settings) {
  return with_settings(settings.stages.empty() ? stages_for_start(settings) : settings.stages, settings);
}

}  // namespace pellicle
