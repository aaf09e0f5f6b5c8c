#pragma once
/// Evenly spread directions: the icosahedron split 1 -> 4 on the unit sphere.

#include <array>
#include <vector>

#include "pellicle/base/geometry.h"

namespace pellicle {

struct Icosphere {
  std::vector<Vec3> directions;               ///< vertices 0 and 1 are exactly +z and -z
  std::vector<std::array<int, 3>> triangles;  ///< outward
};

/// 20 * 4^level triangles. The vertices of a lower level come first, with the same bits.
/// \param level 0 to 8.
Icosphere icosphere(int level);

}  // namespace pellicle
