#pragma once
/// Expert points in a fit: a start from points alone, and how far the surface lies from them.

#include <memory>
#include <optional>

#include "pellicle/fit/plan.h"
#include "pellicle/fit/stage.h"

namespace pellicle {

/// Of points with a weight to the surface as a fine mesh.
PointDistances distances_to(const ExpertPoints& points, const Surface& surface, double h);

/// The ellipsoid with the points' second moments (of points spread over an ellipsoid: that one), when there are twelve
/// or more and they do not lie near a plane: enough to say where the object is all around.
std::optional<Surface> ellipsoid_of(const ExpertPoints& points, const ModelChoice& model, double h);

/// Half the mean gap between the points on the surface drawn to them (three voxels at least): between points it is as
/// uncertain as they are far apart, and there the image may not lead it away (along the brain stem, say).
std::shared_ptr<const SearchLimit> search_limit_of(const Surface& drawn, const ExpertPoints& points, double h);

/// `start` drawn to the points alone by stages of growing detail (FitPlan::outline); where one fails, as it was before.
Surface drawn_to_points(const Image<float>& image, const Surface& start, const ExpertPoints& points,
                        const std::vector<Stage>& stages, const Observer& observer);

}  // namespace pellicle
