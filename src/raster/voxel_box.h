#pragma once
/// The voxels that a surface may touch: work on an object is done in its box, not in the whole volume.

#include <cstddef>

#include "pellicle/image/image_grid.h"
#include "pellicle/mesh/triangle_mesh.h"

namespace pellicle {

/// A box of voxels of a larger grid.
struct VoxelBox {
  Index3 first{0, 0, 0};  ///< its first voxel in the larger grid
  ImageGrid grid;         ///< of the box itself
  bool empty() const { return grid.voxel_count() == 0; }
};

/// The voxels of `grid` that `mesh` may touch, with `margin` voxels around; empty when the mesh lies outside.
VoxelBox box_around(const TriangleMesh& mesh, const ImageGrid& grid, int margin);

/// Calls `body(offset in the whole grid, offset in the box, at the border of the whole grid)` for each voxel of the
/// box.
template <class F>
void for_each_voxel(const VoxelBox& box, const ImageGrid& grid, const F& body) {
  std::size_t inner = 0;
  const auto at_end = [&](int i, std::size_t axis) { return i == 0 || i == grid.size[axis] - 1; };
  for (int k = 0; k < box.grid.size[2]; ++k) {
    for (int j = 0; j < box.grid.size[1]; ++j) {
      const int y = box.first[1] + j, z = box.first[2] + k;
      const bool border = at_end(y, 1) || at_end(z, 2);
      std::size_t outer = grid.offset(box.first[0], y, z);
      for (int i = 0; i < box.grid.size[0]; ++i) body(outer++, inner++, border || at_end(box.first[0] + i, 0));
    }
  }
}

}  // namespace pellicle
