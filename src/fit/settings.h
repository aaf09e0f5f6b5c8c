#pragma once
/// What the stages of a fit are made of. Lengths in units of h, the cube root of the voxel volume, unless a name says
/// mm.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pellicle/base/geometry.h"
#include "pellicle/surface/surface.h"

namespace pellicle {

enum class Polarity { automatic, bright, dark };  ///< object against its background
enum class Boundary { automatic, step, ridge };   ///< a change of level, or a thin membrane along the surface
/// Where a fit from a ball starts: by the image (rays), at the ball itself, at the ellipsoid through the first edges
/// along rays, or at the brain of a head.
enum class StartRule { automatic, sphere, rays, head };
enum class Solver {
  least_squares,        ///< closed form where the surface is linear in its control points, else Levenberg-Marquardt
  levenberg_marquardt,  ///< through Ceres, whatever the model
  gradient,             ///< L-BFGS on the scalar energies, through Ceres
  dynamic  ///< implicit time steps of a moving surface with mass and damping, each solved as the others are
};

/// How a surface moves under `Solver::dynamic` (dynamics.h). Time has no unit of its own: these scale with it.
struct Motion {
  double time_step = 1.0;
  double mass = 0.1;  ///< of the whole surface, spread evenly over its area; 0: first order, no inertia
  double damping = 1.0;
};

/// Points that the surface should pass through (springs). LPS mm.
struct ExpertPoints {
  std::vector<Vec3> points = {};
  std::vector<double> weights = {};  ///< one per point, >= 0; empty: all 1
  bool held = false;                 ///< pull to the point itself; else along the normal only, the point may slide
  void validate() const;             ///< \throws SettingError
};

/// One stage of a fit: which energies, with what weights, on what image, with how many control points. What a plan
/// (plan.h) holds is what runs: nothing below it decides again.
struct Stage {
  std::string name = "region";
  int detail = 1;                           ///< refinements of the control mesh (tetrahedron: 4, 10, 34, 130 points)
  std::map<std::string, double> energies;   ///< name -> weight; see energies/README and `--energy list`
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

/// Every energy that a weight may be given to.
struct EnergyDescription {
  std::string name, kind, formula, text;  ///< kind: "residual" or "scalar"
};
const std::vector<EnergyDescription>& energy_descriptions();

}  // namespace pellicle
