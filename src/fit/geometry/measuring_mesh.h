#pragma once
/// The dense mesh of a surface on which residuals of a fit to geometry are measured.

#include "pellicle/surface/surface.h"

namespace pellicle {

/// \return level of tessellation with 10,000 facets and 30 per control point or more, at most 250,000.
int measuring_level(const SurfaceModel& model);
TriangleMesh measuring_mesh(const Surface& surface);

}  // namespace pellicle
