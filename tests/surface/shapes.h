#pragma once
/// Shapes that the surface tests share.

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "pellicle/base/random.h"
#include "pellicle/surface/surface.h"

namespace pellicle::shapes {

inline const std::vector<StartSolid> kSolids{StartSolid::tetrahedron, StartSolid::octahedron, StartSolid::icosahedron};
inline const std::vector<SubdivisionRule> kRules{SubdivisionRule::smooth, SubdivisionRule::published,
                                                 SubdivisionRule::balanced};
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

inline nlohmann::json golden() {
  std::ifstream in(std::string(PELLICLE_SOURCE_DIR) + "/tests/golden/normal_subdivision.json");
  return nlohmann::json::parse(in).at("normal_subdivision");
}

inline Vec3 vector(const nlohmann::json& row) {
  return Vec3(row.at(0).get<double>(), row.at(1).get<double>(), row.at(2).get<double>());
}

inline Vec3 random_vector(RandomEngine& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

inline Vec3 random_unit(RandomEngine& random) {
  return Vec3(random.normal(), random.normal(), random.normal()).normalized();
}

inline Vec3 point(const Parameters& parameters, int vertex) {
  return Vec3(&parameters[6 * std::size_t(vertex)]);
}
inline Vec3 normal(const Parameters& parameters, int vertex) {
  return Vec3(&parameters[6 * std::size_t(vertex) + 3]);
}
inline void set(Parameters& parameters, int vertex, const Vec3& p, const Vec3& n) {
  std::copy_n(p.data(), 3, &parameters[6 * std::size_t(vertex)]);
  std::copy_n(n.data(), 3, &parameters[6 * std::size_t(vertex) + 3]);
}

/// The unit sphere with every coordinate of points and normals moved by up to `amplitude`.
inline Parameters perturbed_sphere(const NormalModel& model, double amplitude, RandomEngine& random) {
  Parameters result(model.reference());
  for (int v = 0; v < model.vertex_count(); ++v) {
    const Vec3 p = point(result, v) + random_vector(random, amplitude);
    set(result, v, p, (normal(result, v) + random_vector(random, amplitude)).normalized());
  }
  return result;
}

/// A closed mesh of random points on the unit sphere: a tetrahedron whose facets are split again and again where a
/// random direction meets them. Slivers and any valence from 3 up.
inline NormalModel random_inscribed(int vertex_count, SubdivisionRule rule, RandomEngine& random) {
  const NormalModel start = NormalModel::start(StartSolid::tetrahedron, rule);
  Parameters sphere = start.reference();
  auto triangles = start.triangles();
  for (int v = 4; v < vertex_count; ++v) {
    const Vec3 direction = random_unit(random);
    for (std::size_t f = 0; f < triangles.size(); ++f) {
      const auto [a, b, c] = triangles[f];
      Mat3 corners;
      corners << point(sphere, a), point(sphere, b), point(sphere, c);
      if ((corners.inverse() * direction).minCoeff() < 0) continue;
      triangles[f] = {a, b, v};
      triangles.push_back({b, c, v});
      triangles.push_back({c, a, v});
      break;
    }
    sphere.resize(sphere.size() + 6);
    set(sphere, v, direction, direction);
  }
  return {vertex_count, triangles, rule, sphere};
}

inline double flat_volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles) sum += mesh.vertices[a].dot(mesh.vertices[b].cross(mesh.vertices[c]));
  return sum / 6;
}

/// Largest distance from a vertex of `a` to the nearest one of `b`.
inline double farthest(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double worst = 0;
  for (const Vec3& x : a) {
    double best = std::numeric_limits<double>::infinity();
    for (const Vec3& y : b) best = std::min(best, (x - y).norm());
    worst = std::max(worst, best);
  }
  return worst;
}

}  // namespace pellicle::shapes
