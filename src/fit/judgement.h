#pragma once
/// What is made of a fitted candidate: the evidence of the image, its rank among the other candidates, its status.

#include <optional>
#include <string>
#include <vector>

#include "pellicle/fit/stage.h"

namespace pellicle {

struct Judgement {
  Evidence evidence = {};
  double volume = 0.0;  ///< mm^3, of the smooth surface
  /// What candidates are compared by: the evidence, less for a near side of a membrane, for a size far from the seed's,
  /// and for expert points that lie off the surface.
  double credit = 0.0;
  std::optional<PointDistances> points = {};  ///< of the expert points, when there are any
};

/// \param boundary what the user says of it: a near side of a membrane is a bad step unless a step is asked for.
Judgement judge(const StageContext& context, const Candidate& candidate, Boundary boundary);

/// A candidate from its start to where it is now.
struct Attempt {
  Candidate start, now;
  std::vector<StageSummary> stages = {};  ///< all that were run, those whose result was dropped included
  Judgement judgement = {};
  StageRequest last = {};  ///< the stage that led to `now`, so that it can run again
  explicit Attempt(Candidate candidate) : start(candidate), now(std::move(candidate)) {}
};

/// Whether `a` ranks before `b`: one that did not fail, then the larger credit.
bool ranks_before(const Attempt& a, const Attempt& b);

/// Whether no other hypothesis has to be tried: intensities are given, or the evidence is far above that of any known
/// leak.
bool is_decisive(const Attempt& attempt);

/// Credit of the best over that of the best one that found another volume (by more than a fifth); -1: there is none.
double margin_of(const std::vector<Attempt>& attempts, std::size_t best);

/// Summary and status of attempt number `best`, the surface that is handed out.
FitResult result_of(const std::vector<Attempt>& attempts, std::size_t best, double margin);

/// The status that the evidence alone leaves of a fit that ran well.
struct Verdict {
  FitStatus status = FitStatus::ok;
  std::string reason = {};
};
/// \param seed_share volume that a ball seed and the surface share over that of the smaller; none: no ball seed.
/// \param margin as of margin_of; -1: not known.
Verdict verdict_on(const Attempt& attempt, const std::optional<double>& seed_share, double margin);

}  // namespace pellicle
