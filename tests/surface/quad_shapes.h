#pragma once
/// Quad control meshes for tests.

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "pellicle/base/random.h"
#include "pellicle/mesh/quad/quad_mesh.h"
#include "pellicle/mesh/quad/quad_subdivision.h"
#include "pellicle/surface/quad/quad_layout.h"

namespace pellicle::quad_shapes {

inline nlohmann::json golden(const std::string& section) {
  std::ifstream file(std::string(PELLICLE_SOURCE_DIR) + "/tests/golden/any_topology.json");
  return nlohmann::json::parse(file).at(section);
}

inline Vec3 vec(const nlohmann::json& j) {
  return {j.at(0).get<double>(), j.at(1).get<double>(), j.at(2).get<double>()};
}

inline QuadMesh mesh_of(const nlohmann::json& j) {
  QuadMesh mesh;
  for (const auto& p : j.at("P")) mesh.vertices.push_back(vec(p));
  mesh.quads = j.at("F").get<std::vector<Quad>>();
  return mesh;
}

/// 24 vertices of valence 3 to 6, genus 0.
inline QuadMesh golden_mesh() {
  return mesh_of(golden("catmull_clark"));
}

/// A sheet over [0, width] x [0, height] with random heights.
inline QuadMesh sheet(int width, int height, RandomEngine& random) {
  QuadMesh mesh;
  for (int j = 0; j <= height; ++j) {
    for (int i = 0; i <= width; ++i) mesh.vertices.emplace_back(i, j, random.uniform(-0.5, 0.5));
  }
  const auto at = [&](int i, int j) { return j * (width + 1) + i; };
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) mesh.quads.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
  }
  return mesh;
}

inline QuadMesh jittered(QuadMesh mesh, double amplitude, RandomEngine& random) {
  for (Vec3& x : mesh.vertices) {
    x += Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)) * amplitude;
  }
  return mesh;
}

/// Two n-gons one above the other, each split into n quads about its centre, joined by quads: two vertices of valence
/// n, n of valence 3 in the split edges' ends and n of valence 4 or 5.
inline QuadMesh drum(int n) {
  QuadMesh mesh;
  const auto ring = [&](int level, int k) { return 2 + level * 2 * n + (k + 2 * n) % (2 * n); };
  mesh.vertices = {Vec3(0, 0, 1), Vec3(0, 0, -1)};
  for (int level = 0; level < 2; ++level) {
    for (int k = 0; k < 2 * n; ++k) {
      const double angle = 3.14159265358979323846 * k / n;
      mesh.vertices.emplace_back(1.2 * std::cos(angle), 1.2 * std::sin(angle), level == 0 ? 0.6 : -0.6);
    }
  }
  for (int k = 0; k < n; ++k) {
    mesh.quads.push_back({0, ring(0, 2 * k), ring(0, 2 * k + 1), ring(0, 2 * k + 2)});
    mesh.quads.push_back({1, ring(1, 2 * k + 2), ring(1, 2 * k + 1), ring(1, 2 * k)});
  }
  for (int k = 0; k < 2 * n; ++k) mesh.quads.push_back({ring(0, k), ring(1, k), ring(1, k + 1), ring(0, k + 1)});
  return mesh;
}

inline int count(const QuadMesh& mesh) {
  return static_cast<int>(mesh.vertices.size());
}

}  // namespace pellicle::quad_shapes
