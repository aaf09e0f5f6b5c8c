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

ScalarRows rim_spring_rows(const SampleLayout& layout, const SurfaceSamples& samples, const PointTree& rim,
                           double reach, double energy_weight) {
  constexpr int kNearest = 4;
  ScalarRows rows;
  const std::map<int, BorderPlace> border = border_of(layout);
  const auto along = [&](const BorderPlace& p) -> Vec3 {
    return 0.5 * (samples.x[static_cast<std::size_t>(p.after)] - samples.x[static_cast<std::size_t>(p.before)]);
  };
  double length = 0.0;
  for (const auto& [sample, place] : border) {
    if (place.before >= 0 && place.after >= 0) length += along(place).norm();
  }
  for (const auto& [sample, place] : border) {
    if (place.before < 0 || place.after < 0) continue;
    const Vec3& x = samples.x[static_cast<std::size_t>(sample)];
    const Vec3 tangent = along(place);
    const Vec3 outward = tangent.cross(samples.normal[static_cast<std::size_t>(sample)]).normalized();
    const auto near = rim.nearest(x, kNearest);
    if (near.empty() || near.front().distance > reach || !outward.allFinite()) continue;
    double furthest = -reach;
    for (const auto& n : near) {
      furthest = std::max(furthest, outward.dot(rim.points()[static_cast<std::size_t>(n.point)] - x));
    }
    const double root = std::sqrt(2.0 * energy_weight * tangent.norm() / length);
    rows.add(sample, root * outward);
    rows.close(root * (outward.dot(x) + furthest));
  }
  return rows;
}

}  // namespace pellicle
