#pragma once
/// What a fit says of itself: status, stages, hypotheses, evidence, result.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pellicle/fit/settings.h"
#include "pellicle/surface/surface.h"

namespace pellicle {

/// A bad fit is data, not an exception.
enum class FitStatus {
  ok,
  doubtful,       ///< converged, but the evidence along the surface is weak
  ambiguous,      ///< another hypothesis explains the image nearly as well
  not_converged,  ///< step limit reached while still moving
  no_contrast,    ///< no edge to be found
  leaked,         ///< ran away: grew far beyond what the seed saw, with edgeless parts
  collapsed,      ///< shrank to nothing
  folded,         ///< the surface cuts itself
  inside_out,     ///< negative volume
  left_image,     ///< a large part lies outside the volume
};
std::string to_string(FitStatus status);

/// What the original image says of a surface (docs/energies.md).
struct Evidence {
  double score = 0.0;     ///< p25(away) / (sd inside + noise/2) x fraction inside the image; < 0.3 is not to be trusted
  double contrast = 0.0;  ///< median over samples of |inside - outside|, in intensity units
  double noise = 0.0;     ///< robust sd of the image about its local median
  double weak_share = 1.0;     ///< fraction of the area with less than a quarter of the median contrast
  double outside_share = 0.0;  ///< fraction of the area outside the image
  double returning_share =
      0.0;  ///< fraction of the samples behind whose edge, 4.5 to 8 h out, the image is like the inside again
};

/// What one step of a stage came to.
struct StepSummary {
  double move_mm = 0.0;                    ///< area-mean normal move
  std::map<std::string, double> energies;  ///< after the step, weighted, by name; its own targets
};

/// Why a stage ended.
enum class Termination { converged, step_limit, failed };

struct StageSummary {
  std::string name;
  int detail = 0, control_points = 0, degrees_of_freedom = 0, samples = 0;
  int steps = 0;              ///< targets drawn anew
  int solver_iterations = 0;  ///< Levenberg-Marquardt or L-BFGS iterations, all steps
  Termination termination = Termination::step_limit;
  FitStatus failure = FitStatus::ok;  ///< with Termination::failed
  std::string note = {};              ///< what came of the stage: "dropped: held-out samples are not predicted better"
  double last_move_mm = -1.0;         ///< area-mean normal move of the last step
  double rms_residual_mm = -1.0;
  std::map<std::string, double> energy_before, energy_after;  ///< weighted, by name
  std::vector<StepSummary> history;                           ///< one entry a step
  double seconds = 0.0;
  std::string reason() const;  ///< termination and note in words
};

/// One way to read the image (polarity, levels, seed, range) that was fitted and judged.
struct HypothesisSummary {
  std::string name;
  FitStatus status = FitStatus::ok;
  double evidence = 0.0, volume_ml = 0.0;
  bool chosen = false;
};

struct FitSummary {
  FitStatus status = FitStatus::no_contrast;
  std::string reason;                ///< one sentence for the status
  std::vector<StageSummary> stages;  ///< of the chosen hypothesis
  std::vector<HypothesisSummary> hypotheses;
  double margin = -1.0;  ///< evidence of the best over that of the runner-up that is another shape; -1: one only
  Evidence evidence;
  Polarity polarity = Polarity::automatic;
  Boundary boundary = Boundary::step;
  double level_inside = 0.0, level_outside = 0.0;  ///< medians at the surface, intensity units
  std::optional<PointDistances> points = {};       ///< of the expert points, when there are any
  /// Volume that a ball seed and the surface share, over that of the smaller; not set: the seed was no ball.
  std::optional<double> seed_share = {};
  int iterations() const;  ///< all stages
};

/// The surface at one moment of a fit.
struct TraceFrame {
  std::string stage;
  int step = 0;  ///< of the stage; 0: its start
  Surface surface;
};

struct FitResult {
  Surface surface;
  FitSummary summary;
  std::vector<TraceFrame> trace = {};  ///< on the way to `surface`, as FitOptions::trace_every says
};

}  // namespace pellicle
