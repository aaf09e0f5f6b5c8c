#pragma once
/// The fraction of a box on one side of a plane.

#include "pellicle/base/geometry.h"

namespace pellicle {

/// Fraction of the axis-parallel box {|x_a| <= half_a} with normal . x + distance < 0, in [0, 1]. Exact (Scardovelli
/// and Zaleski 2000, eq. 3-9) up to a clamp of 1e-6 on vanishing components of the normal.
/// \param normal any length,
/// not 0.
double box_fraction(double distance, const Vec3& normal, const Vec3& half);

}  // namespace pellicle
