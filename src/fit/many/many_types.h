#pragma once
/// What many objects of one kind are looked for by, and what is found.

#include <cstddef>
#include <optional>
#include <vector>

#include "pellicle/fit/fit_types.h"
#include "pellicle/fit/options.h"
#include "pellicle/seed/blob_scale_space.h"

namespace pellicle {

struct ManySettings {
  FitOptions fit;                     ///< stages empty: the one stage of many objects (plan.h)
  std::optional<RadiusRange> radius;  ///< of the objects, mm; default: estimated
  SeedRules seeds;
};

/// What the image says of one object, in the stabilised intensities.
struct BodyEvidence {
  double response = 0.0;  ///< N at the seed (seed/blob_scale_space.h)
  double contrast = 0.0;  ///< median inside minus median of the ground beside it
  double drop = 0.0;      ///< median fall of the intensity across the surface, where it meets background
  double support = 0.0;   ///< the same over the local contrast, 0..1
  double limited = 0.0;   ///< fraction of the visible surface that ends at a neighbour's territory
  double visible = 1.0;   ///< fraction of the area inside the image
  double radius = 0.0;    ///< of the ball of equal volume, mm
};

struct ManyObject {
  std::size_t source = 0;  ///< number of the seed: of those given, or in the order of response
  Surface surface;
  FitSummary summary;
  BodyEvidence evidence;
};

struct ManyResult {
  std::vector<ManyObject> objects;  ///< in the order of their seeds
  bool dark = false;
  double radius = 0.0;                           ///< typical radius, mm; 0: nothing found
  std::size_t seeds = 0, weak = 0, doubled = 0;  ///< tried; turned down as not like the others; parts of another
  double variation = 0.0;                        ///< median of (p95 - ground) / (p50 - ground) inside the objects
  bool typical_shape = false;  ///< refitted towards the objects' own typical shape, see docs/nuclei.md
};

}  // namespace pellicle
