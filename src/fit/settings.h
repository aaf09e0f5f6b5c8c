#pragma once
/// What a fit is given. Lengths in units of h, the cube root of the voxel volume, unless a name says mm.

#include <optional>
#include <string>
#include <vector>

#include "pellicle/energies/energy_kind.h"
#include "pellicle/energies/point_targets.h"
#include "pellicle/solve/solver.h"
#include "pellicle/surface/surface.h"

namespace pellicle {

enum class Polarity { automatic, bright, dark };  ///< object against its background
enum class Boundary { automatic, step, ridge };   ///< a change of level, or a thin membrane along the surface
enum class StartRule {
  automatic,
  sphere,
  rays,
  head
};  ///< as seeded; ellipsoid through the first edges along rays; brain

/// One stage of a fit: which energies, with what weights, on what image, with how many control points.
struct Stage {
  std::string name = "region";
  int detail = 1;               ///< refinements of the control mesh (tetrahedron: 4, 10, 34, 130 points)
  EnergyWeights energies = {};  ///< see docs/energies.md and `--energy list`
  double resolution = 1.0;      ///< voxels of the working image are about this many h of the input
  double smoothing = 1.0;       ///< Gaussian scale of the image force, in h of the working image
  double reach = 6.0;           ///< furthest edge that is looked for along a normal, in h
  int max_steps = 20;
  double tolerance = 0.05;  ///< stop when the mean normal move falls below, in h
  Solver solver = Solver::least_squares;
  Motion motion = {};     ///< for Solver::dynamic
  void validate() const;  ///< \throws UsageError naming stage, key, value and rule
};

struct FitSettings {
  ModelChoice model;
  StartRule start_rule = StartRule::automatic;
  std::optional<int> detail;  ///< at most so many refinements; default: the fit decides by evidence
  Polarity polarity = Polarity::automatic;
  Boundary boundary = Boundary::automatic;
  std::optional<double> smoothing_mm;  ///< overrides Stage::smoothing
  EnergyWeights energies;              ///< weights in the stages that use the energy; in all, when none does
  std::optional<double> target_volume_ml;
  double volume_weight = 1.0;
  std::optional<int> max_iterations;               ///< overrides Stage::max_steps
  std::optional<double> tolerance;                 ///< overrides Stage::tolerance
  std::optional<Solver> solver;                    ///< overrides Stage::solver
  std::optional<double> time_step, mass, damping;  ///< override Stage::motion
  std::optional<double> error_target_mm;  ///< refine until the error is so small (rms of the edge offsets; with points
                                          ///< also of their distances), and no further; default: by evidence
  ExpertPoints points = {};
  int trace_every = 0;        ///< keep every n-th step of each stage in FitResult::trace; 0: none
  bool similarity = true;     ///< also try hypotheses "similar to the seed" when levels are uncertain
  std::vector<Stage> stages;  ///< empty: the default sequence for the start rule
  void validate() const;      ///< \throws UsageError
};

/// `stages` with what the settings say for all of them: solver, motion, springs where there are points, weights,
/// detail.
std::vector<Stage> with_settings(std::vector<Stage> stages, const FitSettings& settings);

/// The stages that will run: FitSettings::stages or, when there are none, those of the start rule, with_settings.
std::vector<Stage> stages_of(const FitSettings& settings);

}  // namespace pellicle
