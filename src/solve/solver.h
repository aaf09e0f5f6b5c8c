#pragma once
/// How a step is solved, and how a surface moves.

namespace pellicle {

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

}  // namespace pellicle
