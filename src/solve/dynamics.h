#pragma once
/// Surfaces that move: mass, damping and the energies as stiffness and force.
///
/// Lagrange's equation of the sampled surface (Qin, Mandal, Vemuri 1997, Eqs. 16-19; docs/any-topology.md):
///   M x'' + D x' + dE/dx = 0,   M = m A_i/A and D = d A_i/A at sample i,
/// chained to the control points by the surface's Jacobian, so that for x = W c the matrices over the control points
/// are W^T M W and W^T D W, the paper's integrals of J^T J. A time step is implicit: all energies are taken at its end,
///   (m/dt^2)(x+ - 2 x + x-) + (d/dt)(x+ - x) + dE/dx(x+) = 0,
/// which is where E(x+) + w/2 sum_i (A_i/A) |x+_i - y_i|^2 is least, with
///   w = m/dt^2 + d/dt,   y = x + (m/dt^2)/w (x - x-):
/// the static problem and one more quadratic term. Stable for any step. The damping is a backward difference, not the
/// central one of Eq. (31): that one, without mass, leaves even and odd steps without a tie to each other (Eq. 32).

#include <vector>

#include "pellicle/solve/objective.h"

namespace pellicle {

/// w above: what holds the surface back in a step, in the unit of an energy's weight.
double inertia(const Motion& motion);

/// By how much slower than at once a pull of weight 1 (energies/rows.h) is followed: 1 + w/2.
double delay(const Motion& motion);

/// The quadratic term as an operator ("motion"), aimed at rest where the samples are.
GroupedOperator motion_operator(const Motion& motion, const std::vector<double>& area, const std::vector<Vec3>& x,
                                const SampleLayout& layout);

/// Aims it for the next step. \param x, before samples now and a time step ago; the same ones: at rest.
void aim_motion(const Motion& motion, const std::vector<Vec3>& x, const std::vector<Vec3>& before, GroupedOperator& op);

}  // namespace pellicle
