#pragma once
/// One part of a mask, with room around it.

#include <cstdint>

#include "pellicle/image/image.h"

namespace pellicle {

/// The largest part of a mask (joined by faces), alone: its box with `margin` empty voxels more on every side, beyond
/// the volume too, so that what the volume cuts off ends there. \throws BadData when the mask is empty.
Image<std::uint8_t> largest_part(const Image<std::uint8_t>& mask, int margin);

}  // namespace pellicle
