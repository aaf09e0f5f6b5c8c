#include "pellicle/fit/settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pellicle/base/errors.h"
#include "pellicle/fit/setting_rules.h"

namespace pellicle {

void validate_energies(const std::map<std::string, double>& energies, const std::string& key) {
  for (const auto& [name, weight] : energies) {
    const auto& known = energy_descriptions();
    const bool exists = std::any_of(known.begin(), known.end(), [&, n = name](const auto& d) { return d.name == n; });
    require(exists, fmt::format("unknown energy '{}'", name), key, "choose one of the energies that the list names");
    require(std::isfinite(weight), "energy weight", key, fmt::format("is not a finite number: {}={}", name, weight));
    require(weight >= 0.0 || name == "inflation", "energy weight", key,
            fmt::format("must not be negative: {}={}", name, weight));
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

void ExpertPoints::validate() const {
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

const std::vector<EnergyDescription>& energy_descriptions() {
  static const std::vector<EnergyDescription> list{
      {"region", "residual", "t = argmin int q ds + 0.02 t^2/R",
       "two levels: line search along each normal (L-BFGS stages: h/A int q dV)"},
      {"body", "residual", "t = argmax int (I - (a+b)/2)/(a-b) ds/w - 0.075 (t/w)^2",
       "region for many small bodies: levels of the whole body, profiles end at the neighbours' territories"},
      {"edge", "residual", "t = int f ds - w + s^2 (k1+k2)/2", "sub-voxel place of the edge, robust"},
      {"crossing", "residual", "first s with I < low + share (top - low)",
       "first crossing from inside, for the brain in T1"},
      {"bending", "residual", "1/(4 pi) int |trace-free Hessian|^2", "smoothness; zero for ellipsoids"},
      {"tension", "residual", "1/(8 pi) int |grad x|^2", "membrane; pulls together"},
      {"spacing", "residual", "sum A_i/A |tangential move|^2 + fold barrier",
       "keeps control points spread and facets unfolded"},
      {"springs", "residual", "mean w (n . (x - y))^2", "pulls the nearest place to each expert point; needs --points"},
      {"flux", "scalar", "p h^2 s/(c A) int grad(G_s I) . dA", "flux of the smoothed gradient"},
      {"volume", "scalar", "r0^2/2 ((V-V0)/(3 V0))^2", "prior on the volume; needs --target-volume"},
      {"inflation", "scalar", "-h (V-V0)/A", "constant pressure; negative deflates"},
  };
  return list;
}

}  // namespace pellicle
