#pragma once
/// From choices to a plan in which nothing is left to decide: which stages run, from which start, and what may refine
/// the result.

#include <optional>
#include <vector>

#include "pellicle/fit/options.h"

namespace pellicle {

/// What a fit starts from.
enum class StartKind {
  ball,      ///< a seed sphere, given or found
  surface,   ///< a surface that is near the object: a mask, a model
  outlined,  ///< expert points that say where the object is all around (expert_points.h)
  many       ///< one of many objects
};

/// The stages of a hypothesis. Up to `compare_after` hypotheses are compared; the best goes on with the rest.
struct PlanLine {
  std::vector<Stage> stages = {};
  std::size_t compare_after = 0;
};

struct FitPlan {
  StartKind start = StartKind::ball;
  PlanLine first = {};                   ///< of every hypothesis of the first line
  std::optional<PlanLine> around = {};   ///< of a surface: the search around it, the second hypothesis
  std::optional<PlanLine> similar = {};  ///< the second line: ranges of intensities similar to the seed's
  std::vector<Stage> outline = {};       ///< of expert points: what draws the start to them, without an image
  bool near = false;     ///< the start is near the object: the image acts within a search limit (candidate.h)
  bool certain = false;  ///< the first hypothesis is the only one, unless it fails
  std::optional<double> error_target_mm = {};  ///< see FitOptions
  int smoothness_steps = 5;                    ///< of a trial of more or less bending
  int trace_every = 0;
};

/// \param with_points whether there are expert points: they get springs of weight 1 unless a weight is given.
FitPlan plan_for(const FitOptions& options, StartKind start, bool with_points);

/// Whether expert points that outline the object may be where the fit starts.
bool may_start_at_points(const FitOptions& options);

}  // namespace pellicle
