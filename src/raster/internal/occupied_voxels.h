#pragma once
/// The voxels that hold points.

#include <cstdint>
#include <vector>

#include "pellicle/image/image.h"

namespace pellicle {

/// A mask of the voxels that hold points, in the axes of the world.
/// \param points LPS mm, all in the box from `lo` to `hi`.
/// \param h edge of a voxel, mm.
/// \param margin empty voxels on every side of the box.
Image<std::uint8_t> occupied_voxels(const std::vector<Vec3>& points, const Vec3& lo, const Vec3& hi, double h,
                                    int margin);

}  // namespace pellicle
