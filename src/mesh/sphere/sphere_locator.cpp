#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "pellicle/mesh/sphere/sphere_map.h"

namespace pellicle {

namespace {

double det(const Vec3& a, const Vec3& b, const Vec3& c) {
  return a.cross(b).dot(c);
}

}  // namespace

double spherical_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  return 2.0 * std::atan2(det(a, b, c), 1.0 + a.dot(b) + b.dot(c) + c.dot(a));
}

SphereLocator::SphereLocator(const SphereMap& map) : map_(map), across_(map.mesh.triangles.size()) {
  std::map<std::pair<int, int>, int> owner;
  for (std::size_t t = 0; t < across_.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      owner[{map.mesh.triangles[t][i], map.mesh.triangles[t][(i + 1) % 3]}] = static_cast<int>(t);
    }
  }
  for (std::size_t t = 0; t < across_.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      across_[t][i] = owner.at({map.mesh.triangles[t][(i + 1) % 3], map.mesh.triangles[t][i]});
    }
  }
}

SphereLocator::Place SphereLocator::locate(const Vec3& direction, int hint) const {
  const Vec3 d = direction.normalized();
  const auto sides = [&](int t) {
    const auto& c = map_.mesh.triangles[idx(t)];
    const Vec3 &p = map_.direction[idx(c[0])], &q = map_.direction[idx(c[1])], &r = map_.direction[idx(c[2])];
    return Vec3(det(q, r, d), det(r, p, d), det(p, q, d));
  };
  const auto place_in = [&](int t, Vec3 w) {
    w = w.cwiseMax(0.0);
    return Place{t, w / w.sum()};
  };
  const auto in_front = [&](int t) { return map_.direction[idx(map_.mesh.triangles[idx(t)][0])].dot(d) > 0.0; };
  int t = hint >= 0 ? hint : 0;
  for (std::size_t step = 0; step < across_.size(); ++step) {
    const Vec3 w = sides(t);
    int worst = 0;
    const double least = w.minCoeff(&worst);
    if (least >= 0.0 && in_front(t)) return place_in(t, w);
    // On the far side of the sphere all three may be positive: then any edge will do.
    t = across_[idx(t)][idx((worst + 1) % 3)];
  }
  // A walk may go in circles; then all triangles are tried.
  double best = -std::numeric_limits<double>::infinity();
  for (int k = 0; k < static_cast<int>(across_.size()); ++k) {
    const Vec3 w = sides(k);
    const double inside = w.minCoeff() / std::max(w.cwiseAbs().maxCoeff(), 1e-300);
    if (inside > best && in_front(k)) {
      best = inside;
      t = k;
    }
  }
  return place_in(t, sides(t));
}

Vec3 SphereLocator::point_at(const Place& place) const {
  Vec3 x = Vec3::Zero();
  for (std::size_t i = 0; i < 3; ++i) {
    x += place.barycentric[static_cast<int>(i)] * map_.mesh.vertices[idx(map_.mesh.triangles[idx(place.triangle)][i])];
  }
  return x;
}

}  // namespace pellicle
