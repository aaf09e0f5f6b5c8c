#include "pellicle/mesh/triangle_mesh.h"

namespace pellicle {

void append(TriangleMesh& all, const TriangleMesh& part) {
  const auto first = static_cast<int>(all.vertices.size());
  all.vertices.insert(all.vertices.end(), part.vertices.begin(), part.vertices.end());
  all.normals.insert(all.normals.end(), part.normals.begin(), part.normals.end());
  for (const auto& t : part.triangles) all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

}  // namespace pellicle
