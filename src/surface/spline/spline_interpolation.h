#pragma once
/// Splines through points that are given on a grid of parameters.

#include <utility>

#include "pellicle/mesh/points/point_cloud.h"
#include "pellicle/surface/spline/spline_model.h"

namespace pellicle {

/// The spline whose control points are the grid's. Sphere: rows 0 and M2 are the poles; the pole tangents are estimated
/// from the first harmonic of the neighbouring rows, exactly for ellipsoids: T1N = 2 pi/(M1 sin(pi/M2)) sum_k
/// cos(2 pi k/M1) c[k,1], T2N with sin; T1S, T2S likewise from row M2-1 with the sign turned. Open directions (cylinder
/// along v, rectangle both): the row beyond a border continues the parabola through the last three (the line through
/// two), so that quadratic sheets are exact.
/// \throws BadData when the grid is too small or a pole's row holds different points.
std::pair<SplineModel, Parameters> interpolate_grid(const PointGrid& grid, SplineTopology topology);

}  // namespace pellicle
