#pragma once
/// Objects on a voxel grid: work is done in the box of the object, then put into the whole.

#include "pellicle/image/image.h"
#include "pellicle/mesh/triangle_mesh.h"
#include "pellicle/surface/surface.h"

namespace pellicle {

/// A box of voxels: first index, and the grid of the box itself.
struct Box {
  Index3 first{0, 0, 0};
  ImageGrid grid;
  bool empty() const { return grid.voxel_count() == 0; }
};

/// The voxels of `grid` that `mesh` may touch, with `margin` voxels around; empty when the mesh lies outside.
Box box_around(const TriangleMesh& mesh, const ImageGrid& grid, int margin);

/// Calls `body(offset in the whole grid, offset in the box, at the border of the whole grid)` for each voxel of the
/// box.
template <class F>
void for_each_voxel(const Box& box, const ImageGrid& grid, const F& body) {
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

/// Signed distance in mm over the whole grid, negative inside. Exact for `mesh` within ten voxels of it; beyond, from a
/// mesh of some thousand facets of the same surface, within one percent: exact queries far away cost a hundred times
/// more.
Image<float> signed_distance(const Surface& surface, const TriangleMesh& mesh, const ImageGrid& grid);

}  // namespace pellicle
