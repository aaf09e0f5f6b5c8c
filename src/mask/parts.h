#pragma once
/// The parts of a mask (voxels joined by faces): the largest alone, or parts near each other joined to one.

#include <cstddef>
#include <cstdint>

#include "pellicle/image/image.h"

namespace pellicle {

/// Voxels of the largest part become 1, all others 0; of equally large parts the first in memory is kept.
/// \return its voxels; 0 for an empty mask.
std::size_t keep_largest_part(Image<std::uint8_t>& mask);

/// The smallest box that holds every voxel other than 0, with `margin` empty voxels more on every side, beyond the
/// volume too. Voxels keep their places in the world; their values become 0 and 1.
/// \return an image without voxels for an empty mask.
Image<std::uint8_t> cropped(const Image<std::uint8_t>& mask, int margin);

/// The largest part of a mask, alone, cropped with that margin: what the volume cuts off ends there.
/// \throws BadData when the mask is empty.
Image<std::uint8_t> largest_part(const Image<std::uint8_t>& mask, int margin);

/// Joins parts of `least` voxels or more to the largest. Each is joined along the cheapest path from face to face, on
/// which a voxel costs what `field` lacks to one half; the path's voxels and their face neighbours are filled. Parts
/// that are farther than about three voxels of field 0, and smaller ones, vanish.
/// \param mask of values 0 and 1.
/// \param field about 1 inside of the object, 0 outside; of the mask's size.
void join_parts(Image<std::uint8_t>& mask, const Image<float>& field, std::size_t least);

}  // namespace pellicle
