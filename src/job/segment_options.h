#pragma once
/// The choices of a segmentation in memory.

#include <optional>

#include "pellicle/fit/many/many.h"
#include "pellicle/image/image_grid.h"

namespace pellicle {

struct SegmentOptions {
  FitOptions fit = {};                     ///< how each object is fitted, and with which model
  bool many = false;                       ///< many objects of one kind, found or seeded (fit/many.h)
  std::optional<RadiusRange> radius = {};  ///< of many objects, mm; default: estimated
  SeedRules seed_rules = {};               ///< of many objects that are looked for
  std::optional<int> mesh_level = {};      ///< 2^level facets along a control edge; default: facets of half a voxel
  bool fraction_map = false;               ///< also Segmentation::fraction
  bool distance_map = false;               ///< also Segmentation::distance
  bool keep_image = false;                 ///< also Segmentation::image
  std::optional<ImageGrid> map_grid = {};  ///< grid of the maps; default: that of the image
};

/// The part that fit_many takes.
ManySettings many_settings(const SegmentOptions& options);

}  // namespace pellicle
