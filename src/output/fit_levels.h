#pragma once
/// Which sizes of a model `pellicle fit` tries, and how each is judged. For this folder's sources only.

#include "pellicle/output/fit_points.h"

namespace pellicle {

/// \throws UsageError when the kind of model cannot be fitted to this kind of input.
void check_model(ModelKind kind, const GeometryInput& input);

/// Fills result.tried, result.chosen and result.stretch by the settings: one size, a ladder, the fewest control points
/// for a tolerance, or as many as points that are left out of the fit are foretold better by.
void fit_levels(const Observer& observer, GeometryFitResult& result);

}  // namespace pellicle
