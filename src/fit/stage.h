#pragma once
/// Running one stage of a fit.

#include "pellicle/base/observer.h"
#include "pellicle/fit/candidate.h"
#include "pellicle/fit/fit_types.h"
#include "pellicle/fit/settings.h"
#include "pellicle/fit/stage_geometry.h"

namespace pellicle {

/// What a stage is asked for beside what the candidate says.
struct StageRequest {
  Stage stage;
  double first_reach_mm = 0.0;  ///< reach of the first search; 0: the stage's own
  bool hold_out = false;        ///< leave every fourth sample (of edges) and expert point out, and measure there
  int trace_every = 0;          ///< keep every n-th step in the candidate's trace; 0: none
  bool continued = false;       ///< the candidate rested at this stage before; only the points changed
  bool all_samples = false;     ///< the last stage: about one sample per voxel along the surface
};

/// What came of it. The candidate that it was asked for has moved, and its status is not ok when it failed.
struct StageOutcome {
  StageSummary summary;
  double residual_correlation = 1.0;  ///< of the edge offsets of neighbouring samples: near 0 when only noise is left
  double held_out_rms = -1.0;     ///< mm, root of the weighted mean square of all that was left out; -1: not measured
  double held_out_points = -1.0;  ///< mm^2, of the expert points alone (solve/hold_out.h)
  double error = -1.0;            ///< mm, rms of the edge offsets or, if larger, of the expert points
};

/// Values that hold for all stages of a fit.
struct StageContext {
  const Image<float>& image;
  const ExpertPoints& points;
  GeometryCache& geometry;
  const Observer& observer;
};

/// Moves the candidate by one stage; sets its status when the surface ran away, collapsed, folded or left the image.
/// \throws Interrupted when the observer says so.
StageOutcome run_stage(const StageContext& context, const StageRequest& request, Candidate& candidate);

}  // namespace pellicle
