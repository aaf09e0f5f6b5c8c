#pragma once
/// From values that say where objects are to seeds: one entry an object.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pellicle/fit/options.h"
#include "pellicle/image/image.h"
#include "pellicle/job/object_seed.h"

namespace pellicle {

/// Where a fit to points may start when they say where the object is all around (fit/expert_points.h): the solid that
/// they outline (seed/point_outline.h), as a surface; the ball about them where they outline none. None where they do
/// not.
std::optional<Seed> seed_of_points(const ExpertPoints& points, const ImageGrid& grid, const FitOptions& fit);

/// A start surface for each label of a map: its moment ellipsoid fitted to its boundary (surface_from_mask).
/// \param wanted this label alone; default: every one that is not 0.
/// \param name what the map is called in messages.
/// \throws BadData when a label has no voxel or lies outside 1 to 65535.
std::vector<ObjectSeed> seeds_of_labels(const Image<std::int32_t>& map, std::optional<int> wanted,
                                        const FitOptions& fit, const std::string& name = "mask");

/// One object, found without any hint: candidates by contrast, or the head of StartRule::head.
/// \param image in LPS order (in_lps_order).
/// \return no candidate when the image shows no object.
ObjectSeed find_object(const Image<float>& image, const FitOptions& fit);

/// Names objects that have no name "object-LABEL".
/// \throws UsageError when two have the same label.
std::vector<ObjectSeed> numbered(std::vector<ObjectSeed> seeds);

}  // namespace pellicle
