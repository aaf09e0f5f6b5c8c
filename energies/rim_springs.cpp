#include "pellicle/energies/rim_springs.h"

#include <cmath>
#include <vector>

namespace pellicle {

ScalarRows rim_spring_rows(const std::vector<std::vector<int>>& border, const SampleView& surface,
                           const RimLocator& rim, double reach, double energy_weight) {
  ScalarRows rows;
  const auto at = [&](const std::vector<int>& loop, std::size_t i) -> const Vec3& {
    return surface.x[static_cast<std::size_t>(loop[i % loop.size()])];
  };
  double length = 0.0;
  for (const std::vector<int>& loop : border) {
    for (std::size_t i = 0; i < loop.size(); ++i) length += (at(loop, i + 1) - at(loop, i)).norm();
  }
  for (const std::vector<int>& loop : border) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vec3 &before = at(loop, i + loop.size() - 1), &x = at(loop, i), &after = at(loop, i + 1);
      const RimLocator::Place on = rim.nearest(x);
      if (on.distance > reach) continue;
      const double fraction = 0.5 * ((x - before).norm() + (after - x).norm()) / length;
      const double root = std::sqrt(2.0 * energy_weight * fraction);
      for (const Vec3& across : {on.outward, Vec3(on.tangent.cross(on.outward))}) {
        rows.add(loop[i], root * across);
        rows.close(root * across.dot(on.x));
      }
    }
  }
  return rows;
}

}  // namespace pellicle
