#pragma once
/// The readings of an image that are worth a fit, and the start of each. Polarity, levels, membrane or step, range of
/// intensities, candidate seeds: one mechanism for all of them.

#include "pellicle/fit/stage.h"

namespace pellicle {

struct Hypothesis {
  FitState start;
  std::vector<Stage> stages;  ///< up to where hypotheses are compared; the best goes on with the rest
  std::size_t compare_after = 0;
  std::optional<SeedSphere> ball = {};  ///< the seed, where it is one
  double seed_radius = 0.0;             ///< mm, what the ball says of the size; 0: nothing
  bool certain = false;  ///< levels were told or are plain to see: others are tried only if this one fails
};

/// \param name_prefix for reports when there are several seeds.
/// \throws BadData for an image without contrast (head).
std::vector<Hypothesis> hypotheses_for(const Image<float>& image, const Seed& seed, const FitSettings& settings,
                                       const std::string& name_prefix);

/// The second line: "alike the seed" with a ladder of ranges, for objects among other, stronger edges.
std::vector<Hypothesis> similarity_hypotheses(const Image<float>& image, const SeedSphere& seed,
                                              const FitSettings& settings, const std::string& name_prefix);

}  // namespace pellicle
