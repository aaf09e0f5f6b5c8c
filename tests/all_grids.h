#pragma once
/// Grids in every storage order, for tests of what must not depend on it.

#include <algorithm>
#include <array>
#include <vector>

#include "pellicle/image/image_grid.h"

namespace pellicle::test {

/// Every storage order and sign: 48 grids.
inline std::vector<ImageGrid> all_grids() {
  std::vector<ImageGrid> grids;
  std::array<int, 3> order{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      ImageGrid grid;
      grid.size = {20, 24, 28};
      grid.spacing = {1.0, 0.8, 1.3};
      grid.direction.setZero();
      for (int a = 0; a < 3; ++a) {
        grid.direction(order[static_cast<std::size_t>(a)], a) = (signs >> a & 1) != 0 ? -1.0 : 1.0;
      }
      const Vec3 middle(9.5, 11.5, 13.5);
      grid.origin_in_world = -(grid.world_from_index_matrix() * middle);
      grids.push_back(grid);
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return grids;
}

}  // namespace pellicle::test
