#pragma once
/// What a user may choose about a fit, and what a fit is given to work on.

#include <optional>
#include <string>
#include <vector>

#include "pellicle/fit/settings.h"
#include "pellicle/image/image.h"
#include "pellicle/seed/seed.h"
#include "pellicle/surface/surface.h"

namespace pellicle {

/// The choices of a user about a fit; what is not set is decided by the plan. No data.
struct FitOptions {
  ModelChoice model;
  StartRule start_rule = StartRule::automatic;
  std::optional<int> detail;  ///< at most so many refinements; default: the fit decides by evidence
  Polarity polarity = Polarity::automatic;
  Boundary boundary = Boundary::automatic;
  std::optional<double> smoothing_mm;  ///< of the image forces in every stage
  EnergyWeights energies = {};         ///< weights in the stages that use the energy; in all, when none does
  std::optional<double> target_volume_ml;
  double volume_weight = 1.0;
  std::optional<int> max_iterations;               ///< steps at most, of every stage
  std::optional<double> tolerance;                 ///< of every stage, in h
  std::optional<Solver> solver;                    ///< of every stage
  std::optional<double> time_step, mass, damping;  ///< of the motion of every stage
  std::optional<double> error_target_mm;  ///< refine until the error is so small (rms of the edge offsets; with points
                                          ///< also of their distances), and no further; default: by evidence
  int trace_every = 0;                    ///< keep every n-th step of each stage in FitResult::trace; 0: none
  bool similarity = true;                 ///< also try hypotheses "similar to the seed" when levels are uncertain
  std::vector<Stage> stages;              ///< empty: the default sequence for the start rule
  /// \param with_points whether there will be expert points. \throws SettingError naming the key of the setting.
  void validate(bool with_points = false) const;
};

/// `motion` with what the options say of it.
Motion motion_of(Motion motion, const FitOptions& options);

/// The data of a fit.
struct FitInput {
  const Image<float>& image;  ///< whole volume, LPS mm; must outlive the fit
  /// One or more for the same object (automatic seeding gives several); each is a hypothesis.
  std::vector<Seed> seeds = {};
  ExpertPoints points = {};
};

}  // namespace pellicle
