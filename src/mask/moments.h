#pragma once
/// First and second moments of a mask, as a solid.

#include <cstdint>

#include "pellicle/image/image.h"

namespace pellicle {

/// Centroid and the ellipsoid of equal second moments, LPS mm.
struct Moments {
  Vec3 centroid{0, 0, 0};
  Mat3 shape = Mat3::Identity();  ///< unit ball -> ellipsoid, symmetric; columns in mm
  double volume = 0.0;            ///< mm^3
};
/// Voxels other than 0 are inside.
/// \pre the mask is not empty.
Moments moments_of(const Image<std::uint8_t>& mask);

}  // namespace pellicle
