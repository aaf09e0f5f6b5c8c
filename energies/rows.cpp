#include "pellicle/energies/rows.h"

#include <cmath>

namespace pellicle {

ScalarRows offset_rows(const std::vector<Vec3>& x, const std::vector<Vec3>& normal, const std::vector<double>& area,
                       const NormalTargets& targets, double energy_weight) {
  double total = 0.0;
  for (const double a : area) total += a;
  ScalarRows rows;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double w = 2.0 * energy_weight * targets.weight[i] * area[i] / total;
    if (!(w > 0.0)) continue;
    const double root = std::sqrt(w);
    rows.add(static_cast<int>(i), root * normal[i]);
    rows.close(root * (normal[i].dot(x[i]) + targets.offset[i]));
  }
  return rows;
}

}  // namespace pellicle
