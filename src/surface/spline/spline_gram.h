#pragma once
/// L2 inner products of spline surfaces: <a, b> = int int a(u, v) . b(u, v) du dv over the parameter square.
/// Source: Schmitter, Garcia-Amorena, Unser 2017, Eqs. (15), (16).

#include <Eigen/Core>

#include "pellicle/surface/spline/spline_model.h"

namespace pellicle {

/// G(i, j) = int_0^1 B_i B_j dt of one direction's basis functions B_i(t) = phi(m t - k): periodic when closed, cut off
/// at 0 and 1 when open. Exact to rounding (Gauss-Legendre, 8 points per interval). Symmetric, positive definite.
Eigen::MatrixXd gram_matrix(const SplineAxis& axis);

/// Of the blocks: <a, b> = sum over x, y, z of a_axis . G b_axis, entries in the order of blocks(). Symmetric, positive
/// definite: the metric of minimum-energy deformations.
Eigen::MatrixXd gram_matrix(const SplineModel& model);

/// Without that matrix.
/// \throws BadData for parameters of another size.
double inner_product(const SplineModel& model, const Parameters& a, const Parameters& b);

}  // namespace pellicle
