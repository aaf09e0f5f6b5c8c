#include "pellicle/energies/tension.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace pellicle {

VectorRows tension_rows(const SampleLayout& layout) {
  std::map<std::pair<int, int>, double> weight;  // ordered: the rows come out the same every time
  for (const auto& t : layout.triangles) {
    for (std::size_t c = 0; c < 3; ++c) {
      const int i = t[c], j = t[(c + 1) % 3], k = t[(c + 2) % 3];
      const auto& on = layout.on_unit_sphere;
      const Vec3 u = on[static_cast<std::size_t>(i)] - on[static_cast<std::size_t>(k)];
      const Vec3 v = on[static_cast<std::size_t>(j)] - on[static_cast<std::size_t>(k)];
      weight[{std::min(i, j), std::max(i, j)}] += 0.5 * u.dot(v) / u.cross(v).norm();
    }
  }
  // int |grad x|^2 = sum over edges of w_ij |x_i - x_j|^2; rows hold twice the energy.
  VectorRows rows;
  for (const auto& [edge, w] : weight) {
    if (w <= 0.0) continue;
    const double root = std::sqrt(2.0 * w / (8.0 * std::numbers::pi));
    rows.add(edge.first, root);
    rows.add(edge.second, -root);
    rows.close();
  }
  return rows;
}

}  // namespace pellicle
