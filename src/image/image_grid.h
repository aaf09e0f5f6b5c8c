#pragma once
/// Where the voxels of a volume lie in the world.

#include <cmath>
#include <cstddef>

#include "pellicle/base/geometry.h"

namespace pellicle {

/// A regular 3D lattice. Columns of `direction` are the unit world directions of the index axes; any orientation,
/// determinant +1 or -1. Spacing in mm, origin = centre of voxel (0,0,0) in LPS mm.
struct ImageGrid {
  Index3 size{0, 0, 0};
  Vec3 spacing{1, 1, 1};
  Vec3 origin_in_world{0, 0, 0};
  Mat3 direction = Mat3::Identity();

  std::size_t voxel_count() const {
    return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(size[2]);
  }
  std::size_t offset(int i, int j, int k) const {
    return static_cast<std::size_t>(i) +
           static_cast<std::size_t>(size[0]) *
               (static_cast<std::size_t>(j) + static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(k));
  }
  /// Linear part of world_from_index: direction * diag(spacing).
  Mat3 world_from_index_matrix() const { return direction * spacing.asDiagonal(); }
  Mat3 index_from_world_matrix() const { return spacing.cwiseInverse().asDiagonal() * direction.transpose(); }
  Vec3 world_from_index(const Vec3& x_in_index) const {
    return origin_in_world + direction * spacing.cwiseProduct(x_in_index);
  }
  Vec3 index_from_world(const Vec3& x_in_world) const {
    return (direction.transpose() * (x_in_world - origin_in_world)).cwiseQuotient(spacing);
  }
  double voxel_volume() const { return spacing.prod(); }             ///< mm^3
  double mean_spacing() const { return std::cbrt(spacing.prod()); }  ///< h of the recipes, mm
  Vec3 extent() const {                                              ///< edge lengths of the whole volume, mm
    return {spacing[0] * size[0], spacing[1] * size[1], spacing[2] * size[2]};
  }
  /// Inside the box of whole voxels (half a voxel beyond the outermost centres).
  bool contains(const Vec3& x_in_world) const {
    const Vec3 i = index_from_world(x_in_world);
    for (int a = 0; a < 3; ++a) {
      if (!(i[a] >= -0.5 && i[a] <= size[static_cast<std::size_t>(a)] - 0.5)) return false;
    }
    return true;
  }
};

/// Same size, and spacing, origin and direction equal to within `tolerance` of a voxel at every corner.
bool same_grid(const ImageGrid& a, const ImageGrid& b, double tolerance = 1e-3);

}  // namespace pellicle
