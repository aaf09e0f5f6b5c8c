#pragma once
/// Volume enclosed by a closed spline surface, and its gradient. Source: Schmitter, Garcia-Amorena, Unser 2017,
/// Eqs. (17)-(22), with the sign that makes the volume of the sphere positive (docs/models.md). Fits take volumes from
/// the sample mesh (energies/volume.h), which works for every model; this is the exact value for other programs that
/// use the library, and what the tests hold dense meshes against.

#include <vector>

#include "pellicle/surface/spline/spline_model.h"

namespace pellicle {

/// By Gauss-Legendre quadrature over the knot cells; tables of the basis are made once. With s = -1 for the sphere,
/// whose (u, v) are left-handed, and +1 for the torus:
///   V = s/3 int int sigma . (sigma_u x sigma_v),   dV/dc = s int int B_c sigma_u x sigma_v.
/// Relative error with 6 points on shapes whose control points are moved by 15 % of the radius: volume 1e-8, gradient
/// 1e-7; each 100 times less with 8.
class SplineVolume {
 public:
  /// \param points per knot interval and direction.
  /// \throws UsageError for open surfaces.
  explicit SplineVolume(const SplineModel& model, int points = 6);
  /// mm^3.
  /// \throws BadData for parameters of another size.
  double value(const Parameters& parameters) const;
  /// Also adds dV/dparameters to `gradient`, mm^2.
  /// \pre gradient.size() == parameters.size()
  double value_and_gradient(const Parameters& parameters, std::vector<double>& gradient) const;

 private:
  double sum(const Parameters& parameters, std::vector<Vec3>* gradient) const;

  SplineModel model_;
  int points_;
  std::vector<double> weight_;            ///< of the points of one interval, [0, 1]
  std::vector<AxisWeights> by_u_, by_v_;  ///< at every point, interval after interval
};

/// The same as a trilinear form of the control points, Eqs. (21), (22):
///   V = s sum x_i y_j z_k T_ijk,   T = D_u[i,j,k] E_v[i,j,k] - E_u[i,j,k] D_v[i,j,k],
/// where D[i,j,k] = int B_i B_j' B_k and E[i,j,k] = int B_i B_j B_k' are tables of one direction each, 37 entries per
/// control point. Exact to rounding, and slower than the quadrature (docs/models.md).
class SplineVolumeForm {
 public:
  /// \throws UsageError for open surfaces.
  explicit SplineVolumeForm(const SplineModel& model);
  double value_and_gradient(const Parameters& parameters, std::vector<double>& gradient) const;

 private:
  struct Entry {
    int i, j, k;
    double d, e;
  };
  static std::vector<Entry> table_of(const SplineAxis& axis);

  SplineModel model_;
  std::vector<Entry> by_u_, by_v_;
};

}  // namespace pellicle
