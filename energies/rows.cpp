#include "pellicle/energies/rows.h"

#include <cmath>

#include "pellicle/energies/profiles.h"

namespace pellicle {

void downweight_outliers(double h, NormalTargets& targets) {
  std::vector<double> used;
  for (std::size_t i = 0; i < targets.offset.size(); ++i) {
    if (targets.weight[i] > 0.0) used.push_back(targets.offset[i]);
  }
  const double middle = median_of(used), scale = 3.0 * (robust_deviation(used) + 0.05 * h);
  for (std::size_t i = 0; i < targets.offset.size(); ++i) {
    const double ratio = (targets.offset[i] - middle) / scale;
    targets.weight[i] /= 1.0 + ratio * ratio;
  }
}

void apply_correction(NormalTargets& targets) {
  for (std::size_t i = 0; i < targets.correction.size(); ++i) targets.offset[i] += targets.correction[i];
  targets.correction.clear();
}

ScalarRows offset_rows(const SampleView& surface, const NormalTargets& targets, double energy_weight) {
  ScalarRows rows;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const double w = 2.0 * energy_weight * targets.weight[i] * surface.area[i] / surface.total_area;
    if (!(w > 0.0)) continue;
    const double root = std::sqrt(w);
    const Vec3& n = surface.normal[i];
    rows.add(static_cast<int>(i), root * n);
    rows.close(root * (n.dot(surface.x[i]) + targets.offset[i]));
  }
  return rows;
}

}  // namespace pellicle
