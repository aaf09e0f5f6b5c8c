#include "pellicle/fit/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pellicle/fit/setting_rules.h"

namespace pellicle {

Motion motion_of(Motion motion, const FitOptions& options) {
  motion.time_step = options.time_step.value_or(motion.time_step);
  motion.mass = options.mass.value_or(motion.mass);
  motion.damping = options.damping.value_or(motion.damping);
  return motion;
}

namespace {

void require_at_least_zero(const std::optional<double>& value, const std::string& subject, const std::string& key) {
  require(!value || (*value >= 0.0 && std::isfinite(*value)), subject, key,
          fmt::format("must not be negative: {}", value.value_or(0)));
}

void require_above_zero(const std::optional<double>& value, const std::string& subject, const std::string& key,
                        const std::string& unit) {
  require(!value || (*value > 0.0 && std::isfinite(*value)), subject, key,
          fmt::format("must be above 0 {}: {}", unit, value.value_or(0)));
}

void validate_solver(const FitOptions& o) {
  validate_motion(motion_of(Motion{}, o), "time-step, mass, damping");
  const auto moves = [](const Stage& s) { return s.solver == Solver::dynamic; };
  const bool moving = o.solver ? *o.solver == Solver::dynamic : std::any_of(o.stages.begin(), o.stages.end(), moves);
  require(moving || !(o.time_step || o.mass || o.damping), "nothing moves", "time-step, mass, damping",
          "they belong to the solver 'dynamic'");
  require(!o.max_iterations || *o.max_iterations >= 0, "step limit", "max-iterations",
          fmt::format("must not be negative: {}", o.max_iterations.value_or(0)));
  require_at_least_zero(o.tolerance, "tolerance", "tolerance");
  require_above_zero(o.error_target_mm, "error target", "error-target", "mm");
}

// Energies that need data: a target volume, expert points.
void validate_needs(const FitOptions& o, bool with_points) {
  const auto any_stage = [&](auto rule) {
    return rule(o.energies) ||
           std::any_of(o.stages.begin(), o.stages.end(), [&](const Stage& s) { return rule(s.energies); });
  };
  const bool points = any_stage([](const EnergyWeights& w) { return w.uses(&EnergyTraits::needs_points); });
  require(!points || with_points, "the energy 'springs' has no points", "energy, points", "give expert points");
  const bool volume =
      any_stage([](const EnergyWeights& w) { return w.with(&EnergyTraits::needs_target_volume) != nullptr; });
  require(o.target_volume_ml || !volume, "the energy 'volume' has no target", "energy, target-volume",
          "give the target volume in ml");
}

}  // namespace

void FitOptions::validate(bool with_points) const {
  const SurfaceModel start = start_model(model);
  require(is_closed(start), "surface model", "model",
          fmt::format("'{}' is open and encloses no object; use a closed one", model_name(start)));
  for (const Stage& stage : stages) stage.validate();
  validate_energies(energies, "energy");
  require(!detail || (*detail >= 0 && *detail <= 4), "detail", "detail",
          fmt::format("must be 0 to 4: {}", detail.value_or(0)));
  require_at_least_zero(smoothing_mm, "smoothing", "smoothing");
  require_above_zero(target_volume_ml, "target volume", "target-volume", "ml");
  require_at_least_zero(volume_weight, "volume weight", "volume-weight");
  require(trace_every >= 0, "trace", "trace-every", fmt::format("must not be negative: {}", trace_every));
  validate_solver(*this);
  validate_needs(*this, with_points);
}

}  // namespace pellicle
