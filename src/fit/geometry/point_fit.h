#pragma once
/// Fitting a surface to geometry: points or a closed surface, no image.

#include <vector>

#include "pellicle/base/observer.h"
#include "pellicle/fit/geometry/measuring_mesh.h"
#include "pellicle/fit/geometry/point_fit_types.h"

namespace pellicle {

/// A closed surface as data: itself, turned outward, and `samples` points spread over it, with its normals.
GeometryData data_of(TriangleMesh surface, int samples);
/// Largest distance between two points (extremes along 200 directions), mm. 0 for fewer than two.
double diameter_of(const std::vector<Vec3>& points);

/// Places the reference shape so that a model of few control points follows the map best: for the spline this says
/// where the poles go. \param probe a model of the kind that will be fitted, with about a hundred control points.
Correspondence choose_axis(const SphereMap& map, const SurfaceModel& probe);

/// Fits a model from scratch: least squares to the places that the correspondence names, then springs, attached anew
/// until the residual stops falling. \param hold_out every tenth point takes no part; its residual is in the summary.
/// \throws BadData when model and data do not fit together (no reference shape); Interrupted.
PointFit fit_to_map(const SurfaceModel& model, const GeometryData& data, const Correspondence& correspondence,
                    const PointFitSettings& settings, bool hold_out, const Observer& observer = {});
/// The same for a surface that is near the data already.
PointFit fit_from(const Surface& start, const GeometryData& data, const PointFitSettings& settings, bool hold_out,
                  const Observer& observer = {});

/// Residuals both ways and self-intersections, measured on a dense mesh of the surface.
void measure_fit(const GeometryData& data, PointFit& fit);

}  // namespace pellicle
