#pragma once
/// The sizes that a model comes in.

#include <string>
#include <vector>

#include "pellicle/surface/surface.h"

namespace pellicle {

/// More control points than this are not tried for a tolerance.
constexpr int kMostForTolerance = 2600;

/// "10 x 10" for a spline, "34 points" otherwise.
std::string name_of_size(const SurfaceModel& model);
/// The same model with about four times as many control points.
SurfaceModel refined(const SurfaceModel& model);
SurfaceModel spline_of(int m1, int m2);

/// Sizes that are laid out on a map, the fewest control points first, each about 1.5 times the one before.
std::vector<SurfaceModel> sizes_of(const ModelChoice& choice);

}  // namespace pellicle
