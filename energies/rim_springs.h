#pragma once
/// Springs from the border of an open surface to the curve where its data end: springs of points see tangent planes
/// only, so nothing else says where it ends.
///
/// E = sum_i (l_i/L) |(I - t_i t_i^T)(x_i - c_i)|^2 over the samples of the border, l_i the part of its length L that
/// is theirs, c_i the nearest place of the rim's curve and t_i the curve's tangent there: samples slide along it.

#include "pellicle/energies/rows.h"
#include "pellicle/mesh/points/rim.h"

namespace pellicle {

/// \param border of the samples (border_loops of mesh/measure.h); empty: no rows.
/// \param reach mm: samples further from the curves get no row.
ScalarRows rim_spring_rows(const std::vector<std::vector<int>>& border, const SampleView& surface,
                           const RimLocator& rim, double reach, double energy_weight);

}  // namespace pellicle
