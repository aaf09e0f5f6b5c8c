#pragma once
/// Growing, shrinking and filling of masks of values 0 and 1.

#include <cstddef>
#include <cstdint>

#include "pellicle/image/image.h"

namespace pellicle {

/// Dilation, `steps` times: the largest value of the 27 voxels around each.
void grow(Image<std::uint8_t>& mask, int steps);
/// Erosion, `steps` times: the smallest value of the 27 voxels around each; what lies beyond the border counts as 0.
void shrink(Image<std::uint8_t>& mask, int steps);
/// Erosion by the 6 neighbours that share a face; what lies beyond the border counts as 0.
Image<std::uint8_t> shrunk_by_faces(const Image<std::uint8_t>& mask);
/// Every voxel that no path of empty voxels (joined by faces) from the first voxel reaches becomes 1.
/// \pre the voxels at the border of the image are 0.
/// \return how many voxels were filled.
std::size_t fill_cavities(Image<std::uint8_t>& mask);

}  // namespace pellicle
