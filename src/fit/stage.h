#pragma once
/// Running one stage of a fit.

#include <array>
#include <compare>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "pellicle/base/observer.h"
#include "pellicle/energies/geometry.h"
#include "pellicle/fit/candidate.h"
#include "pellicle/fit/objective.h"

namespace pellicle {

/// What depends on the control mesh and the density alone: built once, used by every stage and hypothesis.
struct StageGeometry {
  SampleLayout layout;
  SampleGraph graph;
  /// Samples that a coarser level has too: enough for what is smooth anyway; empty (all) when levels share none.
  std::vector<int> coarse;
  VectorRows bending;  ///< over the coarse samples
  StageGeometry(const SurfaceModel& model, int level);
};

/// Geometries by control mesh, reference shape and level. One subdivision rule a cache. Threads may share it.
class GeometryCache {
 public:
  const StageGeometry& get(const SurfaceModel& model, int level);

 private:
  struct Key {
    std::size_t kind;  ///< alternative of SurfaceModel
    int level;
    std::vector<std::array<int, 3>> control_facets;
    Parameters reference;
    auto operator<=>(const Key&) const = default;
  };
  std::mutex mutex_;
  std::map<Key, StageGeometry> cache_;
};

/// What a stage is asked for beside what the candidate says.
struct StageRequest {
  Stage stage;
  double first_reach_mm = 0.0;  ///< reach of the first search; 0: the stage's own
  bool hold_out = false;        ///< leave every fourth sample (of edges) and expert point out, and measure there
  int trace_every = 0;          ///< keep every n-th step in the candidate's trace; 0: none
  bool all_samples = false;     ///< the last stage: about one sample per voxel along the surface
};

/// What came of it. The candidate that it was asked for has moved, and its status is not ok when it failed.
struct StageOutcome {
  StageSummary summary;
  double residual_correlation = 1.0;  ///< of the edge offsets of neighbouring samples: near 0 when only noise is left
  double held_out_rms = -1.0;     ///< mm, root of the weighted mean square of all that was left out; -1: not measured
  double held_out_points = -1.0;  ///< mm^2, of the expert points alone (expert_points.h)
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

/// How densely a surface is sampled: coarse is enough to place control points, fine to measure edges, all is about one
/// sample per voxel along the surface.
enum class Density { coarse, fine, all };
/// Level at which a surface has about one sample per 3.5 h^2 (`all`: 1.2 h^2); at least 500, at most 16 a control point
/// (`fine`: 4000, `all`: 9000).
int sampling_level(const SurfaceModel& model, double area, double h, Density density);

}  // namespace pellicle
