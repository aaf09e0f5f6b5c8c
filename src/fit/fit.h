#pragma once
/// Fitting one surface to one object.

#include <vector>

#include "pellicle/base/observer.h"
#include "pellicle/fit/fit_types.h"
#include "pellicle/fit/settings.h"
#include "pellicle/seed/seed.h"

namespace pellicle {

/// \param image whole volume, LPS mm.
/// \param seeds one or more candidates for the same object (automatic seeding gives several); each is a hypothesis.
/// \throws UsageError for settings that break a rule and for seeds that are open surfaces; Interrupted.
FitResult fit_surface(const Image<float>& image, const std::vector<Seed>& seeds, const FitSettings& settings,
                      const Observer& observer = {});

/// Start surface from a mask: the moment ellipsoid of its largest part, fitted to the mask's boundary with `detail`
/// refinements, so that the start is the mask up to the model's resolution. A part with handles starts from its voxels
/// instead, with as many control points as these give (splines, whose topology is fixed, do not).
/// \throws BadData when the mask is empty.
Surface surface_from_mask(const Image<std::uint8_t>& mask, const ModelChoice& choice, int detail);

}  // namespace pellicle
