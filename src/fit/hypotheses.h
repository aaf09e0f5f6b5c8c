#pragma once
/// The hypotheses about an image that are worth a fit, each as a candidate that has not been advanced yet. Polarity,
/// levels, membrane or step, range of intensities, candidate seeds: one mechanism for all of them.

#include <string>
#include <vector>

#include "pellicle/fit/stage.h"

namespace pellicle {

/// \param points expert points; empty: none.
/// \param name_prefix for reports when there are several seeds.
/// \throws BadData for an image without contrast (head).
std::vector<Candidate> hypotheses_for(const Image<float>& image, const Seed& seed, const FitOptions& options,
                                      const ExpertPoints& points, const std::string& name_prefix,
                                      const Observer& observer);

/// The second line: "similar to the seed" with a ladder of ranges, for objects among other, stronger edges.
/// \param line the stages that each of them runs.
std::vector<Candidate> similarity_hypotheses(const Image<float>& image, const SeedSphere& seed,
                                             const FitOptions& options, const PlanLine& line,
                                             const std::string& name_prefix);

}  // namespace pellicle
