#include "pellicle/fit/fit_types.h"

namespace pellicle {

std::string to_string(FitStatus status) {
  switch (status) {
    case FitStatus::ok:
      return "ok";
    case FitStatus::doubtful:
      return "doubtful";
    case FitStatus::ambiguous:
      return "ambiguous";
    case FitStatus::not_converged:
      return "not_converged";
    case FitStatus::no_contrast:
      return "no_contrast";
    case FitStatus::leaked:
      return "leaked";
    case FitStatus::collapsed:
      return "collapsed";
    case FitStatus::folded:
      return "folded";
    case FitStatus::inside_out:
      return "inside_out";
    case FitStatus::left_image:
      return "left_image";
  }
  return "unknown";
}

int FitSummary::iterations() const {
  int total = 0;
  for (const auto& stage : stages) total += stage.solver_iterations;
  return total;
}

std::string StageSummary::reason() const {
  std::string text = termination == Termination::converged    ? "converged"
                     : termination == Termination::step_limit ? "step limit"
                                                              : to_string(failure);
  return note.empty() ? text : text + "; " + note;
}

}  // namespace pellicle
