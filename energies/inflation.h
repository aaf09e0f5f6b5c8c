#pragma once
/// inflation: a constant pressure (Cohen 1991). E = -h (V - V0)/A0 in mm^2, V0 and A0 volume and area at the start of
/// the step: weight 1 pushes as hard as edges one voxel outside would pull. Negative weights deflate.

#include <vector>

#include "pellicle/base/geometry.h"

namespace pellicle {

double inflation(double facet_volume, double start_volume, double start_area, double h, double weight,
                 const std::vector<Vec3>& area_vector, std::vector<Vec3>& dE_dx);

}  // namespace pellicle
