#include "pellicle/raster/voxel_box.h"

#include <algorithm>
#include <cmath>

namespace pellicle {

VoxelBox box_around(const TriangleMesh& mesh, const ImageGrid& grid, int margin) {
  VoxelBox box;
  box.grid = grid;
  box.grid.size = {0, 0, 0};
  if (mesh.vertices.empty()) return box;
  Vec3 low = grid.index_from_world(mesh.vertices.front()), high = low;
  for (const auto& vertex : mesh.vertices) {
    const Vec3 index = grid.index_from_world(vertex);
    low = low.cwiseMin(index);
    high = high.cwiseMax(index);
  }
  Index3 size{};
  for (int a = 0; a < 3; ++a) {
    const auto axis = static_cast<std::size_t>(a);
    const double last = grid.size[axis] - 1;
    const double from = std::clamp(std::floor(low[a]) - margin, 0.0, last + 1);
    const double to = std::clamp(std::ceil(high[a]) + margin, -1.0, last);
    box.first[axis] = static_cast<int>(from);
    size[axis] = std::max(0, static_cast<int>(to) - static_cast<int>(from) + 1);
  }
  if (size[0] == 0 || size[1] == 0 || size[2] == 0) return box;
  box.grid.size = size;
  box.grid.origin_in_world = grid.world_from_index(Vec3(box.first[0], box.first[1], box.first[2]));
  return box;
}

}  // namespace pellicle
