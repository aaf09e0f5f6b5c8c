#pragma once
/// Vectors and frames. World is LPS mm (ITK's and DICOM's patient frame: +x left, +y posterior, +z superior); RAS
/// differs by the sign of x and y. An index is a voxel centre, x fastest. Names say the frame: `x_in_world`,
/// `world_from_index`.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>

namespace pellicle {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Index3 = std::array<int, 3>;

/// The number of a vertex, facet or sample as the index of a container.
/// \pre i >= 0.
inline std::size_t idx(int i) {
  return static_cast<std::size_t>(i);
}

/// LPS <-> RAS, its own inverse.
inline Vec3 flip_lps_ras(const Vec3& x) {
  return {-x.x(), -x.y(), x.z()};
}

}  // namespace pellicle
