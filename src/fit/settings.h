#pragma once
/// What the stages of a fit are made of. Lengths in units of h, the cube root of the voxel volume, unless a name says
/// mm.

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
/// Where a fit from a ball starts: by the image (rays), at the ball itself, at the ellipsoid through the first edges
/// along rays, or at the brain of a head.
enum class StartRule { automatic, sphere, rays, head };

/// \throws SettingError for points that are not finite and weights that break a rule.
void validate(const ExpertPoints& expert);

/// One stage of a fit: which energies, with what weights, on what image, with how many control points. What a plan
/// (plan.h) holds is what runs: nothing below it decides again.
struct Stage {
  std::string name = "region";
  int detail = 1;                           ///< refinements of the control mesh (tetrahedron: 4, 10, 34, 130 points)
  EnergyWeights energies = {};              ///< see docs/energies.md
  double resolution = 1.0;                  ///< voxels of the working image are about this many h of the input
  double smoothing = 1.0;                   ///< Gaussian scale of the image force, in h of the working image
  std::optional<double> smoothing_mm = {};  ///< the same in mm, instead of `smoothing`
  double reach = 6.0;                       ///< furthest edge that is looked for along a normal, in h
  int max_steps = 20;                       ///< steps at most
  double tolerance = 0.05;                  ///< stop when the mean normal move falls below, in h
  Solver solver = Solver::least_squares;
  Motion motion = {};                        ///< for Solver::dynamic
  std::optional<double> target_volume = {};  ///< mm^3, of the energy `volume`
  void validate() const;                     ///< \throws UsageError naming stage, key, value and rule
};

}  // namespace pellicle
