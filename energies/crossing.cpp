#include "pellicle/energies/crossing.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pellicle {

NormalTargets crossing_targets(const Profiles& profiles, const SampleGraph& graph, const TissueLevels& levels,
                               const CrossingSettings& settings) {
  const std::size_t n = profiles.values.size() / static_cast<std::size_t>(profiles.count);
  const int origin = static_cast<int>(std::lround(-profiles.first / profiles.step));
  const auto index_of = [&](double s) {
    return std::clamp(static_cast<int>(std::lround((s - profiles.first) / profiles.step)), 0, profiles.count - 1);
  };
  std::vector<double> brightest(n, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < n; ++i) {
    double top = -std::numeric_limits<double>::infinity();
    for (int k = index_of(-settings.look_back); k <= origin; ++k) {
      if (!std::isnan(profiles.row(i)[k])) top = std::max(top, static_cast<double>(profiles.row(i)[k]));
    }
    if (std::isfinite(top)) brightest[i] = std::clamp(top, levels.threshold, std::max(levels.threshold, levels.middle));
  }
  average_over_mesh(graph, 2, brightest);
  NormalTargets targets{std::vector<double>(n, 0.0), std::vector<double>(n, 1.0)};
  for (std::size_t i = 0; i < n; ++i) {
    const float* p = profiles.row(i);
    if (std::isnan(p[origin]) || std::isnan(brightest[i])) {
      targets.weight[i] = 0.0;
      continue;
    }
    const double cut = levels.low + settings.fraction * (brightest[i] - levels.low);
    double found = settings.reach;
    for (int k = index_of(-settings.depth); k <= index_of(settings.reach); ++k) {
      if (std::isnan(p[k])) {
        if (k > origin) found = std::min(found, profiles.position(k - 1));  // the image ends here
        if (k > origin) break;
        continue;
      }
      if (p[k] < cut) {
        const bool between = k > 0 && !std::isnan(p[k - 1]) && p[k - 1] > p[k] && p[k - 1] >= cut;
        found = profiles.position(k) - (between ? profiles.step * (cut - p[k]) / (p[k - 1] - p[k]) : 0.0);
        break;
      }
    }
    targets.offset[i] = std::clamp(found, -settings.cap, settings.cap);
  }
  return targets;
}

TermOutput CrossingTerm::operator()(const StepView& step) const {
  if (!step.hypothesis.tissue) return {};
  const SampleView& surface = step.surface;
  const TrilinearField field(*step.image);
  TissueLevels levels = *step.hypothesis.tissue;
  if (step.detail > 1) {
    Vec3 centre = Vec3::Zero();
    for (std::size_t i = 0; i < surface.size(); ++i) centre += surface.area[i] / surface.total_area * surface.x[i];
    levels.middle = median_of(values_inside(field, surface.x, centre, 1));
  }
  const CrossingSettings settings;
  const Profiles profiles = sample_profiles(field, surface, settings.depth, settings.reach, std::min(1.0, step.h));
  return {crossing_targets(profiles, *surface.graph, levels, settings)};
}

}  // namespace pellicle
