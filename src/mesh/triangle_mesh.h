#pragma once
/// A triangle mesh in LPS mm. A plain value; algorithms are free functions in this folder.

#include <array>
#include <vector>

#include "pellicle/base/geometry.h"

namespace pellicle {

/// Triangles are counter-clockwise seen from outside.
struct TriangleMesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<int, 3>> triangles;
  std::vector<Vec3> normals;  ///< outward unit normals, one per vertex, or empty when unknown
};

/// Puts `part` beside what `all` holds.
/// \pre both have normals, or neither.
void append(TriangleMesh& all, const TriangleMesh& part);

}  // namespace pellicle
