#pragma once
/// A solid from scattered points of an open surface: a cup, filled up to its opening.

#include <cstdint>
#include <vector>

#include "pellicle/image/image.h"

namespace pellicle {

/// Voxels from which nearly half of all directions or more meet the points. For a convex cup with a plane opening this
/// is all that lies below the opening, which covers half of all directions there. The largest part, cavities filled.
/// \param spacing typical distance between neighbouring points, mm; voxels are three times that or more.
/// \throws BadData when the points enclose nothing, as a plane sheet does.
Image<std::uint8_t> filled_cup(const std::vector<Vec3>& points, double spacing);

}  // namespace pellicle
