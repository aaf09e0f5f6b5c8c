#pragma once
/// Connected parts of masks, and where they are thickest.

#include <cstdint>
#include <vector>

#include "pellicle/image/image.h"

namespace pellicle {

/// A 6-connected part of a mask.
struct Component {
  int id = 0;  ///< value in the label image, from 1
  std::size_t voxels = 0;
  Vec3 deepest{0, 0, 0};  ///< LPS mm, a voxel centre furthest from the part's border
  /// Its distance from the border, mm (city-block in voxels times the mean spacing, a lower bound in shape).
  double depth = 0.0;
};

struct Components {
  Image<std::int32_t> labels;    ///< 0 outside the mask
  std::vector<Component> parts;  ///< largest first; ids follow this order
};
Components components_of(const Image<std::uint8_t>& mask);
/// The others become 0.
void keep_largest_part(Image<std::uint8_t>& mask);

/// Moments of a mask: centroid and the ellipsoid of equal second moments (unit ball -> ellipsoid, symmetric matrix),
/// LPS mm.
struct Moments {
  Vec3 centroid{0, 0, 0};
  Mat3 shape = Mat3::Identity();
  double volume = 0.0;  ///< mm^3
};
/// \pre the mask is not empty.
Moments moments_of(const Image<std::uint8_t>& mask);

}  // namespace pellicle
