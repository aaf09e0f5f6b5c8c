#pragma once
/// A solid for an open surface: filled up to its mouth.

#include <cstdint>
#include <vector>

#include "pellicle/image/image.h"

namespace pellicle {

/// Voxels from which nearly half of all directions or more meet the points: for a convex cup with a plane mouth this is
/// all that lies below the mouth, since the mouth itself covers half a turn there. The largest part, cavities filled.
/// \param spacing typical distance between neighbouring points, mm; voxels are three times that or more.
/// \throws BadData when the points enclose nothing, as a plane sheet does.
Image<std::uint8_t> filled_cup(const std::vector<Vec3>& points, double spacing);

}  // namespace pellicle
