#pragma once
/// Springs along the rim of an open surface: springs of points see tangent planes only, so nothing else tells it where
/// to end.
///
/// E = sum_i (l_i/L) (b_i . x_i - h_i)^2 over the samples of the border, l_i their share of its length L, b_i the unit
/// vector along the surface and outward across the border, h_i the furthest along b_i of the four nearest rim points.

#include "pellicle/energies/rows.h"
#include "pellicle/mesh/point_tree.h"
#include "pellicle/surface/samples.h"

namespace pellicle {

/// \param reach mm: samples further from the rim's points get no row. No rows for a closed layout.
ScalarRows rim_spring_rows(const SampleLayout& layout, const SurfaceSamples& samples, const PointTree& rim,
                           double reach, double energy_weight);

}  // namespace pellicle
