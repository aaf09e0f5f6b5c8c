#include "pellicle/mesh/triangle_mesh.h"

#include <utility>

#include "pellicle/mesh/measure.h"

namespace pellicle {

void append(TriangleMesh& all, const TriangleMesh& part) {
  const auto first = static_cast<int>(all.vertices.size());
  all.vertices.insert(all.vertices.end(), part.vertices.begin(), part.vertices.end());
  all.normals.insert(all.normals.end(), part.normals.begin(), part.normals.end());
  for (const auto& t : part.triangles) all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

void turn_outward(TriangleMesh& mesh) {
  if (volume_of(mesh) >= 0.0) return;
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  for (auto& normal : mesh.normals) normal = -normal;
}

}  // namespace pellicle
