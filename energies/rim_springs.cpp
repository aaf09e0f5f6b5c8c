#include "pellicle/energies/rim_springs.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace pellicle {

namespace {

/// Of a border sample: the samples before and after it, the surface to the left.
struct BorderPlace {
  int before = -1, after = -1;
};

std::map<int, BorderPlace> border_of(const SampleLayout& layout) {
  std::vector<std::pair<int, int>> sides;
  sides.reserve(3 * layout.triangles.size());
  for (const auto& t : layout.triangles) {
    for (std::size_t c = 0; c < 3; ++c) sides.emplace_back(t[c], t[(c + 1) % 3]);
  }
  std::sort(sides.begin(), sides.end());
  std::map<int, BorderPlace> border;
  for (const auto& [a, b] : sides) {
    if (std::binary_search(sides.begin(), sides.end(), std::pair(b, a))) continue;
    border[a].after = b;
    border[b].before = a;
  }
  return border;
}

}  // namespace

ScalarRows rim_spring_rows(const SampleLayout& layout, const SurfaceSamples& samples, const RimLocator& rim,
                           double reach, double energy_weight) {
  ScalarRows rows;
  const std::map<int, BorderPlace> border = border_of(layout);
  const auto length_at = [&](const BorderPlace& p) {
    if (p.before < 0 || p.after < 0) return 0.0;
    return 0.5 * (samples.x[static_cast<std::size_t>(p.after)] - samples.x[static_cast<std::size_t>(p.before)]).norm();
  };
  double length = 0.0;
  for (const auto& [sample, place] : border) length += length_at(place);
  for (const auto& [sample, place] : border) {
    const double share = length_at(place) / length;
    const RimLocator::Place on = rim.nearest(samples.x[static_cast<std::size_t>(sample)]);
    if (!(share > 0.0) || on.distance > reach) continue;
    const double root = std::sqrt(2.0 * energy_weight * share);
    for (const Vec3& across : {on.outward, Vec3(on.tangent.cross(on.outward))}) {
      rows.add(sample, root * across);
      rows.close(root * across.dot(on.x));
    }
  }
  return rows;
}

}  // namespace pellicle
