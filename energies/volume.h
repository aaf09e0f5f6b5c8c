#pragma once
/// volume: a prior on the enclosed volume. E = r0^2/2 ((V - V0)/(3 V0))^2, r0 the radius of a ball of volume V0: for a
/// sphere half the squared error of its radius, in mm^2.

#include <vector>

#include "pellicle/energies/term.h"

namespace pellicle {

/// \param volume of the facets and \param correction, the factor from facet volume to that of the smooth surface (held
/// fixed). Adds derivatives by x; dV/dx_i is a_i to within the facets (exact for the facet volume).
double volume_prior(double facet_volume, double correction, double target, double weight,
                    const std::vector<Vec3>& area_vector, std::vector<Vec3>& dE_dx);

/// Pulls where a target is given.
struct VolumeTerm {
  TermOutput operator()(const StepView& step) const;
};

}  // namespace pellicle
