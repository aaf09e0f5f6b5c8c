#pragma once
/// Which of many fitted objects are objects: what the image says of each, held against what it says of most.

#include <vector>

#include "pellicle/energies/body.h"
#include "pellicle/fit/many/many_types.h"

namespace pellicle {

/// All but `response` and `radius`. Drop and support are medians over the samples that meet background; over all
/// visible ones where those are less than a quarter of them (in dense tissue touching sides have no drop).
BodyEvidence evidence_of_body(const ImageGrid& grid, const std::vector<Vec3>& x, const std::vector<double>& area,
                              const BodyReading& reading);

/// Robust deviation of v, smoothed by a quarter of the radius, outside all surfaces.
double ground_deviation(const BlobField& field, double radius, const std::vector<Surface>& surfaces,
                        const std::vector<bool>& counted);

/// What good fits have in common: medians.
struct TypicalBody {
  double contrast = 0.0, drop = 0.0, response = 0.0, radius = 0.0, support = 0.0;
};
TypicalBody typical_body(const std::vector<BodyEvidence>& evidence);

/// Those whose contrast, drop and response are not far below the median of the good fits, or that stand out clearly
/// from a clean ground, and whose size is not far off (or in `range`). A radius of 0 marks a fit that failed.
std::vector<bool> accepted_objects(const std::vector<BodyEvidence>& evidence, const TypicalBody& typical,
                                   double ground_deviation, const std::optional<RadiusRange>& range);

/// Of two that share more than half of the smaller, the one with less evidence goes.
std::vector<bool> without_duplicates(const std::vector<Surface>& surfaces, const std::vector<BodyEvidence>& evidence,
                                     const std::vector<bool>& counted);

}  // namespace pellicle
