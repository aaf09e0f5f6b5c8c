#pragma once
/// A fit to geometry with files at both ends: points, a mesh or a mask to a surface, its model and a report.

#include "pellicle/base/observer.h"
#include "pellicle/output/fit_result.h"

namespace pellicle {

/// \throws what settings.validate(), read_geometry, fit_geometry and the writers throw; CannotCreate when an output
/// exists (before any work); Interrupted.
GeometryFitResult fit_to_files(const GeometryFitSettings& settings, const RunRecord& record, const Observer& observer);

GeometryFitOptions options_of(const GeometryFitSettings& settings);

}  // namespace pellicle
