#pragma once
/// The exponential-spline interpolator phi_M and its polynomial limit.
/// Source: Schmitter, Garcia-Amorena, Unser 2017, Eq. (23); the form that is stable for every M is in docs/models.md.

namespace pellicle {

/// Value and derivatives by t.
struct GeneratorValue {
  double value = 0.0, first = 0.0, second = 0.0;
};

enum class SplineGenerator {
  exponential,  ///< reproduces constants and cos, sin(2 pi t / M): exact circles and spheres
  keys,         ///< Catmull-Rom / Keys cubic: the limit M -> infinity, reproduces quadratics
};

/// phi_M(t): even, supported on (-2, 2), phi_M(k) = delta_k, sums to one over integer shifts. C1; the second derivative
/// is bounded and jumps at t = +-1, +-2 (the value from the inside of [0, 1) and [1, 2) is returned).
class Generator {
 public:
  /// \param m shifts per period, at least 3 (ignored by `keys`).
  /// \throws UsageError.
  Generator(SplineGenerator kind, int m);
  GeneratorValue at(double t) const;
  /// phi'(1) = -(pi/M)/sin(2 pi/M); -1/2 for `keys`.
  double slope_at_one() const { return slope_; }

 private:
  GeneratorValue step_up(double r) const;
  GeneratorValue end_slope(double r) const;

  /// theta = pi/M; sinc(theta), (1 - cos theta)/theta^2, (theta - sin theta)/theta^3 and the difference of the last
  /// two.
  double theta_, slope_, sinc_, c2_, s3_, k_;
};

}  // namespace pellicle
