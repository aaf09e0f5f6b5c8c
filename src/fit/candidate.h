#pragma once
/// A candidate: one hypothesis about the image with the surface that it led to so far. A value that fits are made of:
/// it is proposed, advanced by stages, judged, and kept or dropped.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pellicle/energies/term.h"
#include "pellicle/fit/fit_types.h"
#include "pellicle/fit/plan.h"
#include "pellicle/fit/settings.h"
#include "pellicle/mesh/distance.h"
#include "pellicle/seed/seed.h"
#include "pellicle/surface/surface.h"

namespace pellicle {

/// The image pulls the surface only within this distance of a given mesh: the outline that expert points draw, or the
/// seed surface that is refined.
struct SearchLimit {
  SearchLimit(const TriangleMesh& mesh, double length_mm) : outline(mesh), length(length_mm) {}
  ClosestPoint outline;
  double length;  ///< mm
};

struct Candidate {
  Surface surface;
  int detail = 0;  ///< refinements so far
  Reading reading = {};
  Levels levels = {};    ///< as re-estimated so far
  double blur_mm = 0.0;  ///< of the image along the surface, once measured
  FitStatus status = FitStatus::ok;
  std::string reason = {};
  std::vector<TraceFrame> trace = {};

  PlanLine line = {};                   ///< the stages that it runs
  double first_reach_mm = 0.0;          ///< reach of the search of the first stage; 0: the stage's own
  double start_volume = 0.0;            ///< mm^3, of the seed; 0: not known
  std::optional<SeedSphere> ball = {};  ///< the seed, where it is one
  double seed_radius = 0.0;             ///< mm, what the ball says of the size; 0: nothing
  bool certain = false;                 ///< levels are given or plain to see: others are tried only if this one fails
  std::shared_ptr<const SearchLimit> limit = {};
  OneOfMany one_of_many = {};  ///< what it points to must outlive the fit
};

}  // namespace pellicle
