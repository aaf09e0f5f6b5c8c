#pragma once
/// Scattered points of a surface, with weights or on a grid of parameters. LPS mm.

#include <optional>
#include <vector>

#include "pellicle/base/geometry.h"

namespace pellicle {

/// Points on a grid of parameters (u, v): what a tensor-product surface interpolates.
struct PointGrid {
  int columns = 0;           ///< along u, k = 0..columns-1
  int rows = 0;              ///< along v, l = 0..rows-1
  std::vector<Vec3> points;  ///< k fastest
  const Vec3& at(int k, int l) const {
    return points[static_cast<std::size_t>(l) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(k)];
  }
};

struct PointCloud {
  std::vector<Vec3> points;
  std::vector<double> weights;    ///< one per point, >= 0; empty: all count the same
  std::optional<PointGrid> grid;  ///< of a .csv with columns u_index,v_index (or k,l)
};

}  // namespace pellicle
