#pragma once
/// inflation: a pressure (Cohen 1991). E = -h t + h sign(w) t^2/(2 L) in mm^2 with t = (V - V0)/A0 the mean move
/// outward since the start of the step, V0 and A0 volume and area there, L = 4 h: weight 1 pushes as hard at first as
/// edges half a voxel outside would pull, and nothing is gained beyond a move of L a step, so that a step is bounded
/// whatever opposes it (a plain -h t has no minimum: t grows with the cube of the size). Negative weights deflate.

#include <vector>

#include "pellicle/energies/term.h"

namespace pellicle {

double inflation(double facet_volume, double start_volume, double start_area, double h, double weight,
                 const std::vector<Vec3>& area_vector, std::vector<Vec3>& dE_dx);

struct InflationTerm {
  TermOutput operator()(const StepView& step) const;
};

}  // namespace pellicle
