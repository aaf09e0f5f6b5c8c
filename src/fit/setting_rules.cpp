#include "pellicle/fit/setting_rules.h"

#include <fmt/format.h>

#include <cmath>

namespace pellicle {

void validate_energies(const EnergyWeights& energies, const std::string& key) {
  for (const auto& [kind, weight] : energies) {
    require(std::isfinite(weight), "energy weight", key,
            fmt::format("is not a finite number: {}={}", kind->name, weight));
    require(weight >= kind->least_weight, "energy weight", key,
            fmt::format("must not be negative: {}={}", kind->name, weight));
  }
}

void validate_motion(const Motion& motion, const std::string& key) {
  require(motion.time_step > 0.0 && std::isfinite(motion.time_step), "time step", key,
          fmt::format("must be above 0: {}", motion.time_step));
  require(motion.mass >= 0.0 && std::isfinite(motion.mass), "mass", key,
          fmt::format("must not be negative: {}", motion.mass));
  require(motion.damping >= 0.0 && std::isfinite(motion.damping), "damping", key,
          fmt::format("must not be negative: {}", motion.damping));
  require(motion.mass + motion.damping > 0.0, "motion", key,
          "nothing holds the surface back, mass and damping are both 0; give one of them");
}

}  // namespace pellicle
