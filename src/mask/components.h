#pragma once
/// Connected parts of a mask, and where each is thickest.

#include <cstdint>
#include <vector>

#include "pellicle/image/image.h"

namespace pellicle {

/// A part of a mask whose voxels are joined by faces (6 neighbours).
struct Component {
  int id = 0;  ///< value in the label image, from 1
  std::size_t voxels = 0;
  Vec3 deepest{0, 0, 0};  ///< LPS mm, a voxel centre farthest from the part's border
  /// Its distance from the border, mm: city-block distance in voxels times the mean spacing.
  double depth = 0.0;
};

struct Components {
  Image<std::int32_t> labels;    ///< 0 outside the mask
  std::vector<Component> parts;  ///< largest first; ids follow this order
};
/// Voxels other than 0 are inside. The border of the image counts as a border of the parts.
Components components_of(const Image<std::uint8_t>& mask);

}  // namespace pellicle
