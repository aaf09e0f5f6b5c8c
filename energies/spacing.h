#pragma once
/// spacing: keeps the samples, and with them the control points, evenly spread, and the surface from folding; mm^2.
///
/// E = sum_i (A_i/A) |(I - n_i n_i^T)(x_i - x0_i)|^2                                     samples do not slide in a step
///   + r^2/F sum_f max(0, 1/4 - N_f . n_f / a_f)^2                           facets keep a quarter of their size
/// N_f the facet's area vector, n_f the mean of its samples' normals, a_f its area on the reference shape scaled to
/// the total A, r^2 = A/(4 pi), F the number of facets. The second sum is zero for a healthy surface.

#include "pellicle/energies/rows.h"
#include "pellicle/energies/term.h"

namespace pellicle {

/// Linearised at x (normals held). The first sum runs over the coarser samples (their areas are scaled to A).
ScalarRows spacing_rows(const SampleView& surface, double energy_weight);

struct SpacingTerm {
  TermOutput operator()(const StepView& step) const { return {spacing_rows(step.surface, step.weight)}; }
};

}  // namespace pellicle
