#pragma once
/// Many objects of one kind in one image: found, or given by seeds, each with a small fit of its own.
///
/// Every object is fitted alone on a small piece of the image with the energy `body` (energies/body.h), inside its
/// territory, by the stages of fit/stage.h: independent, hence parallel and the same for any number of threads. The
/// first fits see the variance-stabilised image and are what objects are judged by; the last ones see the image itself.

#include <optional>
#include <string>
#include <vector>

#include "pellicle/base/observer.h"
#include "pellicle/fit/fit_types.h"
#include "pellicle/fit/plan.h"
#include "pellicle/seed/blob_scale_space.h"
#include "pellicle/seed/seed.h"

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

/// Where objects seem to be, as balls of their typical radius, the clearest first: what fit_many starts from.
std::vector<SeedSphere> detect_many(const Image<float>& image, const ManySettings& settings);

/// Finds and fits. The image is smoothed in place: move it in where it is not needed any more. It is not an error when there is no object.
/// \throws UsageError for settings that break a rule; Interrupted.
ManyResult fit_many(Image<float> image, const ManySettings& settings, const Observer& observer = {});

/// From seeds, one object each; none is turned down for weak evidence (it is doubtful then), but of two that turn out
/// to be one object the second goes. Balls are placed as given; surfaces that are already near are kept as starts.
ManyResult fit_many(Image<float> image, const std::vector<Seed>& seeds, const ManySettings& settings,
                    const Observer& observer = {});

}  // namespace pellicle
