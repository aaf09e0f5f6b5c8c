#pragma once
/// Fitting one surface to one object.

#include "pellicle/base/observer.h"
#include "pellicle/fit/fit_types.h"
#include "pellicle/fit/options.h"
#include "pellicle/seed/seed.h"

namespace pellicle {

/// From hypotheses to a judged surface: the one-shot of SurfaceFit.
/// \param input seeds: one or more for the same object (automatic seeding gives several); each gives hypotheses.
/// \pre at least one seed.
/// \throws SettingError for options and points that break a rule.
/// \throws UsageError for seeds that are open surfaces.
/// \throws Interrupted when the observer says so.
FitResult fit_surface(const FitInput& input, const FitOptions& options, const Observer& observer = {});

/// Start surface from a mask: the moment ellipsoid of its largest part, fitted to the mask's boundary with `detail`
/// refinements, so that the start is the mask up to the model's resolution. A part with handles starts from its voxels
/// instead, with as many control points as these give (splines, whose topology is fixed, do not).
/// \throws BadData when the mask is empty.
Surface surface_from_mask(const Image<std::uint8_t>& mask, const ModelChoice& choice, int detail);

}  // namespace pellicle
