#pragma once
/// Splines through points that are given on a grid of parameters.

#include <utility>

#include "pellicle/mesh/point_file.h"
#include "pellicle/surface/spline_model.h"

namespace pellicle {

/// The spline whose control points are the grid's: sphere (rows 0 and M2 are the poles) or torus. The pole tangents are
/// estimated from the first harmonic of the neighbouring rows, exactly for ellipsoids: T1N = 2 pi/(M1 sin(pi/M2)) sum_k
/// cos(2 pi k/M1) c[k,1], T2N with sin; T1S, T2S likewise from row M2-1 with the sign turned.
/// \throws BadData when the grid is too small, a pole's row holds different points, or the topology is an open one.
std::pair<SplineModel, Parameters> interpolate_grid(const PointGrid& grid, SplineTopology topology);

}  // namespace pellicle
