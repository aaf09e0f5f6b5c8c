#include "pellicle/image/image_grid.h"

namespace pellicle {

bool same_grid(const ImageGrid& a, const ImageGrid& b, double tolerance) {
  if (a.size != b.size) return false;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 index;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      index[static_cast<int>(axis)] = (corner >> axis & 1) != 0 ? a.size[axis] - 1 : 0;
    }
    if (!((b.index_from_world(a.world_from_index(index)) - index).norm() <= tolerance)) return false;
  }
  return true;
}

}  // namespace pellicle
