#pragma once
/// What is left out of a fit and measured instead: a surface that predicts it better is the better one.

#include "pellicle/energies/point_targets.h"
#include "pellicle/energies/rows.h"

namespace pellicle {

/// Every n-th item, by a fixed draw.
bool is_held_out(std::size_t item, unsigned n);

/// Of the measured offsets of a surface's samples, weighted by area and certainty.
struct OffsetErrors {
  double rms = -1.0;                   ///< mm, of the samples that take part; -1: there are none
  double held_out_rms = -1.0;          ///< mm, of those left out; -1: none were
  double neighbour_correlation = 1.0;  ///< of the offsets of neighbouring samples (Moran 1950): 0 for noise
};

/// Measures the offsets; then, with `hold_out`, every fourth sample is left out: its weight becomes 0.
OffsetErrors measure_offsets(const SampleView& surface, bool hold_out, NormalTargets& targets);

/// Leaves every fourth point out. \return mm^2, their mean square distance, far ones counted as the robust weights say;
/// -1: none were left out.
double hold_out_points(PointTargets& targets);

/// Springs (energies/springs.h) of the points that take part.
ScalarRows spring_rows(const SampleLayout& layout, const PointTargets& targets, double energy_weight);

}  // namespace pellicle
