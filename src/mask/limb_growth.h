#pragma once
/// Growth of a mask of coarse voxels along thin limbs of an object, without a change of topology.

#include <cstdint>

#include "pellicle/image/image.h"

namespace pellicle {

/// Whether the middle of 27 voxels may change between inside and outside without a change of topology: a simple point
/// of digital topology, object by faces, background by corners (Bertrand and Malandain 1994).
/// \param inside bit 9 z + 3
/// y + x.
bool is_simple(std::uint32_t inside);

/// Adds voxels to the mask until each octant that holds some of the object lies in it or touches a voxel of it, or
/// until nothing more can be added: only simple ones are, so parts and handles stay as they are. Voxels that hold more
/// octants come first.
/// \param octants of the object in each voxel, bit 4 z + 2 y + x; of the mask's grid.
void grow_along_limbs(Image<std::uint8_t>& mask, const Image<std::uint8_t>& octants);

}  // namespace pellicle
