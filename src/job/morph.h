#pragma once
/// Shapes between two surfaces, measured: values in, values out.

#include <optional>
#include <vector>

#include "pellicle/base/observer.h"
#include "pellicle/base/phase_clock.h"
#include "pellicle/fit/fit_types.h"
#include "pellicle/mesh/triangle_mesh.h"
#include "pellicle/surface/morph.h"

namespace pellicle {

struct MorphOptions {
  int steps = 5;  ///< shapes, equally spaced in tau
  MorphSpace space = MorphSpace::plane;
  double from = 0.0, to = 1.0;         ///< tau of the first and the last step; one step only: the middle between them
  std::optional<int> mesh_level = {};  ///< 2^level facets along a control edge; default: enough to look at
};
/// One tau for each step; the ends 0 and 1 are met exactly.
std::vector<double> taus_of(const MorphOptions& options);

/// One shape on the way.
struct MorphStep {
  double tau = 0.0;  ///< 0: the first surface, 1: the second
  Surface surface;
  TriangleMesh mesh = {};                ///< as it is written: outward, LPS mm
  FitStatus status = FitStatus::ok;      ///< or folded, or inside_out
  std::optional<double> volume_ml = {};  ///< of the smooth surface; none for open ones
  double area_mm2 = 0.0;
  std::size_t self_intersections = 0;
  bool watertight = false;
  int genus = 0;
};

struct Morphing {
  ShapeMoments moments;
  int points_a = 0, points_b = 0, points = 0;  ///< control points as given, and of every step
  double moved_a_mm = 0.0, moved_b_mm = 0.0;   ///< how far bringing both to one control mesh moved the surfaces
  std::vector<MorphStep> steps;
  PhaseSeconds seconds;  ///< wall time of "match" and "morph"
};

/// \throws as match_surfaces and morph_path (surface/morph.h); Interrupted.
Morphing morph(const Surface& a, const Surface& b, const MorphOptions& options = {}, const Observer& observer = {});

}  // namespace pellicle
