#pragma once
/// The scalar energies of a stage (flux, region integral, volume, inflation), bound to its image and its present
/// surface.

#include "pellicle/fit/stage.h"

namespace pellicle {

struct ScalarInputs {
  const Stage& stage;
  const Candidate& state;
  const StageGeometry& geometry;
  const Image<float>& image;  ///< working image
  double h, area, volume;     ///< of the working grid; of the surface's facets at the start of the step
};

/// Those with a weight; empty for a pure least-squares stage.
std::vector<ScalarEnergy> scalar_energies(const ScalarInputs& inputs);

}  // namespace pellicle
