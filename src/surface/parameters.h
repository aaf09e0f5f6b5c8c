#pragma once
/// The unknowns of a surface model: blocks of three scalars each.

#include <vector>

namespace pellicle {

enum class BlockKind {
  point,        ///< control point in LPS mm, R^3
  unit_normal,  ///< unit vector, the sphere S^2 (ceres::SphereManifold<3>)
  vector,       ///< free vector in mm (pole tangents), R^3
};

/// Three consecutive scalars of `Parameters`, starting at 3 * block.
using Parameters = std::vector<double>;

}  // namespace pellicle
