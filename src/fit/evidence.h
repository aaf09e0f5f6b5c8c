#pragma once
/// What the original image says of a fitted surface, whatever energies made it: one yardstick for every hypothesis.

#include "pellicle/fit/stage.h"

namespace pellicle {

/// Profiles of the image, smoothed by 0.7 h, along the normals of the fitted surface; h is that of the image, or a
/// twentieth of the object's radius where that is more. away = |out - a| - |in - a| is how much less like the object's
/// median a the outside is than the inside. The score takes the lower quarter of `away` over the surface, because a
/// leak makes part of it edgeless, over (spread inside + noise/2 + 0.02 of the image's range), times the fraction
/// inside the image. For a membrane: away = height of the ridge above the higher of its two sides.
Evidence evidence_of(const Image<float>& image, const Surface& surface, bool ridge, GeometryCache& geometry);

}  // namespace pellicle
