#pragma once
/// Meshes for tests, made here from formulas.

#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <utility>

#include "pellicle/base/random.h"
#include "pellicle/mesh/triangle_mesh.h"

namespace pellicle::test {

/// Icosahedron, each facet split in four `level` times, vertices on the sphere; normals exact.
inline TriangleMesh sphere(int level, double radius, const Vec3& centre = Vec3::Zero()) {
  const double g = std::numbers::phi;
  TriangleMesh m;
  m.normals = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
               {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  for (Vec3& n : m.normals) n.normalize();
  m.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                 {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                 {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int l = 0; l < level; ++l) {
    std::map<std::pair<int, int>, int> middle;
    const auto split = [&](int a, int b) {
      const auto [at, fresh] = middle.try_emplace(std::minmax(a, b), static_cast<int>(m.normals.size()));
      if (fresh) m.normals.push_back((m.normals[std::size_t(a)] + m.normals[std::size_t(b)]).normalized());
      return at->second;
    };
    const auto before = std::move(m.triangles);
    m.triangles.clear();
    for (const auto& [a, b, c] : before) {
      const int ab = split(a, b), bc = split(b, c), ca = split(c, a);
      m.triangles.insert(m.triangles.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
  }
  for (const Vec3& n : m.normals) m.vertices.push_back(centre + radius * n);
  return m;
}

/// Axis along z.
inline TriangleMesh torus(int around, int across, double ring, double tube, const Vec3& centre = Vec3::Zero()) {
  TriangleMesh m;
  const double turn = 2.0 * std::numbers::pi;
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const double u = turn * i / around, v = turn * j / across;
      const Vec3 n(std::cos(u) * std::cos(v), std::sin(u) * std::cos(v), std::sin(v));
      m.vertices.emplace_back(centre + ring * Vec3(std::cos(u), std::sin(u), 0) + tube * n);
      const auto at = [&](int a, int b) { return a % around * across + b % across; };
      m.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      m.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return m;
}

inline TriangleMesh box(const Vec3& lo, const Vec3& hi) {
  TriangleMesh m;
  for (int c = 0; c < 8; ++c) {
    m.vertices.emplace_back((c & 1) != 0 ? hi.x() : lo.x(), (c & 2) != 0 ? hi.y() : lo.y(),
                            (c & 4) != 0 ? hi.z() : lo.z());
  }
  m.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                 {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  return m;
}

/// Both as one mesh.
inline TriangleMesh together(TriangleMesh a, const TriangleMesh& b) {
  const int shift = static_cast<int>(a.vertices.size());
  a.normals.clear();
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& [i, j, k] : b.triangles) a.triangles.push_back({i + shift, j + shift, k + shift});
  return a;
}

inline TriangleMesh inside_out(TriangleMesh m) {
  for (auto& t : m.triangles) std::swap(t[1], t[2]);
  return m;
}

inline TriangleMesh moved(TriangleMesh m, const std::function<Vec3(const Vec3&)>& map) {
  m.normals.clear();
  for (Vec3& v : m.vertices) v = map(v);
  return m;
}

/// A lumpy star-shaped surface.
inline TriangleMesh blob(int level, double radius, const Vec3& centre) {
  return moved(sphere(level, 1.0), [&](const Vec3& n) -> Vec3 {
    const double r =
        1.0 + 0.25 * std::sin(3.0 * n.x() + 1.0) * std::cos(2.0 * n.y()) + 0.15 * std::sin(5.0 * n.z() + n.x());
    return centre + radius * r * n;
  });
}

inline Mat3 random_rotation(RandomEngine& random) {
  return Eigen::Quaterniond(random.normal(), random.normal(), random.normal(), random.normal())
      .normalized()
      .toRotationMatrix();
}

}  // namespace pellicle::test
