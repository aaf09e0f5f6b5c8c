#pragma once
/// Running one stage of a fit.

#include <array>
#include <compare>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "pellicle/energies/geometry.h"
#include "pellicle/fit/fit.h"
#include "pellicle/fit/objective.h"
#include "pellicle/fit/reading.h"
#include "pellicle/mesh/distance.h"

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

/// Where the image may draw a surface that expert points outline: further off than this it has no say.
struct Leash {
  Leash(const TriangleMesh& mesh, double length_mm) : outline(mesh), length(length_mm) {}
  ClosestPoint outline;
  double length;  ///< mm
};

/// What is known of an object among others of its kind. Nothing by default.
struct Crowd {
  const Image<float>* territory = nullptr;       ///< above 1/2 where the object may be; profiles end there
  double radius = 0.0;                           ///< mm, of a typical object; 0: unknown
  const std::vector<double>* typical = nullptr;  ///< mm from the centroid, of a typical object, one a sample
};

/// What one stage hands to the next.
struct FitState {
  Surface surface;
  int detail = 0;  ///< refinements so far
  Reading reading = {};
  Levels levels = {};     ///< as re-estimated so far
  double reach_mm = 0.0;  ///< reach of the next search; 0: the stage's own
  double blur_mm = 0.0;   ///< of the image along the surface, once measured
  FitStatus status = FitStatus::ok;
  std::string reason = {};
  double start_volume = 0.0;          ///< mm^3, of the seed
  bool all_samples = false;           ///< the last stage: as many samples as there are voxels along the surface
  bool hold_out = false;              ///< leave every fourth sample (of edges) and expert point out, and measure there
  double residual_correlation = 1.0;  ///< of the edge offsets of neighbouring samples: near 0 when only noise is left
  double held_out_rms = -1.0;  ///< mm, of what was left out, after the last stage that did so: root of the weighted sum
  double held_out_points = -1.0;  ///< mm^2, of the expert points alone (expert_points.h)
  double error = -1.0;  ///< mm, after the last stage: rms of the edge offsets or, if larger, of the expert points
  std::shared_ptr<const Leash> leash = {};
  Crowd crowd = {};  ///< must outlive the fit
  std::vector<TraceFrame> trace = {};
};

/// Values that hold for all stages of a fit.
struct StageContext {
  const Image<float>& image;
  const FitSettings& settings;
  GeometryCache& geometry;
};

/// Runs `stage` on `state`; sets state.status when the surface ran away, collapsed, folded or left the image.
StageSummary run_stage(const StageContext& context, const Stage& stage, FitState& state);

/// How densely a surface is sampled: enough for where the control points go; for what the edges say; every voxel's
/// word.
enum class Density { coarse, fine, all };
/// Level at which a surface has about one sample per 3.5 h^2 (`all`: 1.2 h^2); at least 500, at most 16 a control point
/// (`fine`: 4000, `all`: 9000).
int sampling_level(const SurfaceModel& model, double area, double h, Density density);

}  // namespace pellicle
