#pragma once
/// crossing: the first place, seen from inside, where the image falls below a threshold that follows the tissue; for
/// the brain in T1 images, where beyond a thin dark layer other bright tissue begins. The fixed point of the force of
/// BET (Smith 2002, Human Brain Mapping 17:143-155), found by a search along the normal.

#include "pellicle/energies/profiles.h"
#include "pellicle/energies/rows.h"
#include "pellicle/energies/term.h"

namespace pellicle {

struct CrossingSettings {
  double fraction = 0.66;   ///< threshold between low (0) and the brightest point just inside (1)
  double look_back = 10.0;  ///< mm, where the brightest point is looked for
  double depth = 12.0;      ///< mm, how far inside the search begins
  double reach = 5.0;       ///< mm outward
  double cap = 4.0;         ///< mm, largest move of a step
};

/// \pre profiles cover [-depth, reach].
NormalTargets crossing_targets(const Profiles& profiles, const SampleGraph& graph, const TissueLevels& levels,
                               const CrossingSettings& settings);

/// Pulls where the hypothesis knows the levels of the tissue. With more than ten control points the median of the
/// tissue is taken inside the present surface.
struct CrossingTerm {
  TermOutput operator()(const StepView& step) const;
};

}  // namespace pellicle
