#include "pellicle/fit/settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pellicle/base/errors.h"
#include "pellicle/fit/setting_rules.h"

namespace pellicle {

void validate(const ExpertPoints& expert) {
  const std::vector<Vec3>& points = expert.points;
  const std::vector<double>& weights = expert.weights;
  require(weights.empty() || weights.size() == points.size(), "expert points", "points",
          fmt::format("{} points and {} weights", points.size(), weights.size()));
  bool usable = points.empty();
  for (std::size_t k = 0; k < points.size(); ++k) {
    require(points[k].allFinite(), "expert points", "points", fmt::format("point {} is not finite", k + 1));
    const double w = weights.empty() ? 1.0 : weights[k];
    require(w >= 0.0 && std::isfinite(w), "expert points", "points",
            fmt::format("the weight of point {} must not be negative: {}", k + 1, w));
    usable = usable || w > 0.0;
  }
  require(usable, "expert points", "points", "all weights are 0; give one above 0");
}

void Stage::validate() const {
  const std::string key = fmt::format("stage '{}'", name);
  require(detail >= 0 && detail <= 4, "detail", key, fmt::format("must be 0 to 4: {}", detail));
  require(resolution >= 0.0 && resolution <= 100.0, "resolution", key,
          fmt::format("must be 0 (automatic) to 100: {}", resolution));
  require(smoothing >= 0.0 && smoothing <= 20.0, "smoothing", key, fmt::format("must be 0 to 20: {}", smoothing));
  require(!smoothing_mm || (*smoothing_mm >= 0.0 && std::isfinite(*smoothing_mm)), "smoothing_mm", key,
          fmt::format("must not be negative: {}", smoothing_mm.value_or(0)));
  require(reach > 0.0 && reach <= 200.0, "reach", key, fmt::format("must be above 0 and at most 200: {}", reach));
  require(max_steps >= 0 && max_steps <= 100000, "max_steps", key, fmt::format("must be 0 to 100000: {}", max_steps));
  require(tolerance >= 0.0 && std::isfinite(tolerance), "tolerance", key,
          fmt::format("must not be negative: {}", tolerance));
  validate_energies(energies, key);
  validate_motion(motion, key);
}

}  // namespace pellicle
