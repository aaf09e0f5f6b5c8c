#pragma once
/// A surface in index coordinates, with the facets that each slice of voxels meets.

#include <string>
#include <vector>

#include "pellicle/image/image_grid.h"
#include "pellicle/mesh/triangle_mesh.h"

namespace pellicle {

/// Vertices in index coordinates, facets wound so that outside is on the same side as in the world (a grid with a
/// negative determinant mirrors: its facets are turned round), and for each slice the facets that reach it.
struct IndexMesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<int, 3>> triangles;
  std::vector<std::size_t> slice_begin;  ///< size nz + 1, into `slice_triangles`
  std::vector<int> slice_triangles;      ///< ascending within a slice

  /// The facets with a point in [k - reach, k + reach] for each slice k of `grid`.
  /// \throws BadData when the surface is not closed; `what` opens the message.
  IndexMesh(const TriangleMesh& surface, const ImageGrid& grid, double reach, const std::string& what);
};

}  // namespace pellicle
