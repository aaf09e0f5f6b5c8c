#pragma once
/// Expert points in a fit: springs to the nearest place of the surface, and a start from points alone.

#include <memory>
#include <optional>

#include "pellicle/fit/fit.h"
#include "pellicle/fit/objective.h"
#include "pellicle/fit/stage.h"

namespace pellicle {

/// Springs of one step, and what they say of the present surface.
struct ExpertRows {
  NamedRows rows;
  PointDistances distances;  ///< of the surface's sample mesh
  double held_out = -1.0;    ///< mm^2, mean square distance of the points left out, far ones counted as Huber does
};

/// Springs (energies/springs.h) to the places that are nearest now. Weights are Huber's: full up to c, c/distance
/// beyond it, c the larger of 2 h and three robust deviations, so that a stray point pulls no harder the further off it
/// is. (Weights that fall to nothing would lose the points where the image leads the surface astray.) \param h of the
/// working image, mm. \param hold_out leave every fourth point out (by a fixed draw) and measure there.
ExpertRows expert_rows(const ExpertPoints& points, const SampleLayout& layout, const SurfaceSamples& samples,
                       double weight, double h, bool hold_out);

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
