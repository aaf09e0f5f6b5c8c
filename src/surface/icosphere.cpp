#include "pellicle/surface/icosphere.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <unordered_map>
#include <utility>

namespace pellicle {
namespace {

Icosphere icosahedron() {
  Icosphere result{{{0, 0, 1}, {0, 0, -1}}, {}};
  const double z = 1.0 / std::sqrt(5.0), rho = 2.0 * z;
  for (const int half : {0, 1}) {  // upper ring 2..6, lower ring 7..11, turned by half a step
    for (int k = 0; k < 5; ++k) {
      const double angle = 2.0 * std::numbers::pi * (k + 0.5 * half) / 5.0;
      result.directions.emplace_back(rho * std::cos(angle), rho * std::sin(angle), half == 0 ? z : -z);
    }
  }
  for (int k = 0; k < 5; ++k) {
    const int next = (k + 1) % 5, up = 2 + k, up_next = 2 + next, low = 7 + k, low_next = 7 + next;
    result.triangles.push_back({0, up, up_next});
    result.triangles.push_back({up, low, up_next});
    result.triangles.push_back({up_next, low, low_next});
    result.triangles.push_back({1, low_next, low});
  }
  return result;
}

}  // namespace

Icosphere icosphere(int level) {
  Icosphere sphere = icosahedron();
  for (int step = 0; step < level; ++step) {
    std::unordered_map<std::uint64_t, int> middles;  // by both ends of an edge
    middles.reserve(3 * sphere.triangles.size() / 2);
    const auto middle = [&](int a, int b) {
      const auto key = (static_cast<std::uint64_t>(std::min(a, b)) << 32) | static_cast<std::uint64_t>(std::max(a, b));
      const auto [at, is_new] = middles.try_emplace(key, static_cast<int>(sphere.directions.size()));
      if (is_new) {
        const Vec3 sum = sphere.directions[a] + sphere.directions[b];
        sphere.directions.push_back(sum.normalized());
      }
      return at->second;
    };
    std::vector<std::array<int, 3>> split;
    split.reserve(4 * sphere.triangles.size());
    for (const auto& [a, b, c] : sphere.triangles) {
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      split.insert(split.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    sphere.triangles = std::move(split);
  }
  return sphere;
}

}  // namespace pellicle
