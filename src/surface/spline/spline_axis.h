#pragma once
/// One parameter direction of a tensor-product spline surface.

#include <array>

#include "pellicle/surface/spline/spline_generator.h"

namespace pellicle {

/// The four control points that a parameter value depends on, their weights, and the weights of the derivative by the
/// parameter in [0, 1].
struct AxisWeights {
  int cell = 0;  ///< knot interval, 0..m-1
  std::array<int, 4> row{};
  std::array<double, 4> value{}, slope{};
};

/// m knot intervals over t in [0, 1]. Closed: m control points, repeated with period m. Open: m + 3, of which the first
/// and the last lie one interval before and behind.
class SplineAxis {
 public:
  /// \param period of the exponential generator (m around a circle, 2m along a meridian).
  SplineAxis(SplineGenerator kind, int period, int m, bool closed) : phi_(kind, period), m_(m), closed_(closed) {}

  const Generator& phi() const { return phi_; }
  int m() const { return m_; }
  bool closed() const { return closed_; }
  int rows() const { return closed_ ? m_ : m_ + 3; }
  /// Of control point k = -1..m+1.
  int row(int k) const { return closed_ ? (k + m_) % m_ : k + 1; }
  /// At t = knots / m.
  /// \pre 0 <= knots <= m, or any number when closed.
  AxisWeights at(double knots) const;

 private:
  Generator phi_;
  int m_;
  bool closed_;
};

}  // namespace pellicle
