#pragma once
/// The rule that puts one new vertex on an edge of a normal-based subdivision surface: value (for any scalar type),
/// hand-written forward derivative and hand-written adjoint. Formulas and sources: docs/models.md.
///
/// An edge runs from (p0, n0) to (p1, n1); `d` is the vector from the vertex opposite on its right to the one opposite
/// on its left (used by `convex_direction` only). Normals are free 3-vectors in every derivative; the rule is meant
/// for unit ones. No input below 1e70 in magnitude gives NaN or infinity: see `fallback_normal`.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "pellicle/base/geometry.h"

namespace pellicle {

enum class EdgeRule {
  convex,            ///< `smooth` on control edges: convex weights, perpendicular normal
  convex_direction,  ///< `smooth` inside a control triangle: normal across the parameter direction d
  balanced,          ///< equal weights, perpendicular normal
  published,         ///< weights by the unsigned angles, sum of the unit binormals
};

template <class T>
using Vector3 = Eigen::Matrix<T, 3, 1>;

template <class T>
struct PointNormal {
  Vector3<T> p, n;
};

/// Derivative of one new vertex, with e = p1 - p0:
/// dp = (dp0 + dp1) / 2 + p_e de + p_n0 dn0 + p_n1 dn1,   dn = n_e de + n_n0 dn0 + n_n1 dn1 + n_d dd.
struct EdgeDerivative {
  Mat3 p_e, p_n0, p_n1, n_e, n_n0, n_n1, n_d;
};

/// Inputs of the double-precision derivatives.
struct EdgeEnds {
  const Vec3 &p0, &n0, &p1, &n1;
  const Vec3& d;
};

/// Cotangents of the inputs, added to.
struct EdgeCotangents {
  Vec3 &p0, &n0, &p1, &n1;
  Vec3& d;
};

/// Value and derivative. Without the normal, n and the n_ matrices are left untouched.
template <EdgeRule rule, bool with_normal>
void differentiate_edge(const EdgeEnds& in, PointNormal<double>& value, EdgeDerivative& derivative);

/// Adds the cotangents of the inputs for the cotangents (bar_p, bar_n) of the new vertex; bar_n counts as zero
/// without the normal.
template <EdgeRule rule, bool with_normal>
void pull_back_edge(const EdgeEnds& in, const Vec3& bar_p, const Vec3& bar_n, const EdgeCotangents& bars);

/// Normal where the rule has none (coinciding ends, opposite normals): the unit vector orthogonal to e nearest to m or,
/// failing that, to n0; its derivative counts as zero.
Vec3 fallback_normal(const Vec3& e, const Vec3& m, const Vec3& n0);

namespace edge_detail {

constexpr double kTinySquaredLength = 1e-280;  ///< stands for e.e = 0
constexpr double kSteep = 0.04;                ///< z = cos^2 below which the handle factor is continued by a parabola
constexpr double kPublishedSteep = 1e-8;       ///< the printed rule is only kept from dividing by zero
constexpr double kConvexScale = 0.1;           ///< delta of the convex weight
constexpr double kLeastConvexity = 1e-100;     ///< s0 s1 below which the convex weight is 1/2 to the last bit
constexpr double kDegenerateNormal = 1e-12;    ///< relative length below which a normal has no direction

/// value, first and second derivative at kSteep of G(z) = 1/(sqrt z (1 + sqrt z)).
constexpr double kG0 = 1 / 0.24, kGu1 = 0.5 / 0.2 + 1, kGu2 = -0.25 / (0.2 * 0.04);
constexpr double kG1 = -kGu1 / (0.24 * 0.24), kG2 = 2 * kGu1 * kGu1 / (0.24 * 0.24 * 0.24) - kGu2 / (0.24 * 0.24);

/// Handle factor: a handle is 4 w G(1 - s^2) times the edge projected into the tangent plane.
template <EdgeRule rule, class T>
inline T handle_factor(const T& z) {
  using std::sqrt;
  if constexpr (rule == EdgeRule::published) {
    if (z < T(kPublishedSteep)) return T(1 / (1e-4 * (1 + 1e-4)));
  } else if (z < T(kSteep)) {
    const T x = z - T(kSteep);
    return T(kG0) + x * (T(kG1) + T(0.5 * kG2) * x);
  }
  return T(1) / (sqrt(z) + z);
}

/// 1/|binormal| of the printed rule up to the common factor |e|.
template <class T>
inline T binormal_factor(const T& z) {
  using std::sqrt;
  if (z < T(kPublishedSteep)) return T(1e4);
  return T(1) / sqrt(z);
}

/// Weight of the handle at p0; that at p1 is 1 - w0.
template <EdgeRule rule, class T>
inline T handle_weight(const T& s0, const T& s1) {
  using std::abs;
  if constexpr (rule == EdgeRule::balanced) return T(0.5);
  if constexpr (rule == EdgeRule::published) {
    const T sum = abs(s0) + abs(s1);
    if (sum < T(1e-14)) return T(0.5);
    return abs(s1) / sum;
  }
  const T x = s0 * s1;
  if (!(x > T(kLeastConvexity))) return T(0.5);
  const T x2 = x * x;
  return T(0.5) + T(0.5) * (s1 - s0) * x2 / ((s0 + s1) * (x2 + T(kConvexScale * kConvexScale)));
}

/// Factor a of the chord in the tangent t = a e - (a-1)/2 (h0 + h1).
template <EdgeRule rule>
inline constexpr double chord_factor = rule == EdgeRule::convex_direction ? 2.0 : 1.5;

/// Everything that value, derivative and adjoint have in common.
template <EdgeRule rule, class T>
struct EdgeTerms {
  Vector3<T> e, t0, t1;
  T squared, inverse, a0, a1, s0, s1, z0, z1, w0, G0, G1, g0, g1;

  EdgeTerms(const Vector3<T>& p0, const Vector3<T>& n0, const Vector3<T>& p1, const Vector3<T>& n1) : e(p1 - p0) {
    using std::sqrt;
    squared = e.dot(e);
    if (squared < T(kTinySquaredLength)) squared = T(kTinySquaredLength);
    inverse = T(1) / sqrt(squared);
    a0 = n0.dot(e);
    a1 = n1.dot(e);
    s0 = -a0 * inverse;
    s1 = a1 * inverse;
    t0 = e - a0 * n0;
    t1 = e - a1 * n1;
    z0 = T(1) - s0 * s0;
    z1 = T(1) - s1 * s1;
    w0 = handle_weight<rule, T>(s0, s1);
    G0 = handle_factor<rule, T>(z0);
    G1 = handle_factor<rule, T>(z1);
    g0 = T(4) * w0 * G0;
    g1 = (T(4) - T(4) * w0) * G1;
  }
  Vector3<T> point(const Vector3<T>& p0, const Vector3<T>& p1) const {
    return T(0.5) * (p0 + p1) + T(0.125) * (g0 * t0 - g1 * t1);
  }
  Vector3<T> tangent() const {
    constexpr double a = chord_factor<rule>;
    return T(a) * e - T(0.5 * (a - 1)) * (g0 * t0 + g1 * t1);
  }
  Vector3<T> mean_normal(const Vector3<T>& n0, const Vector3<T>& n1) const {
    if constexpr (rule == EdgeRule::published) return binormal_factor(z0) * n0 + binormal_factor(z1) * n1;
    return n0 + n1;
  }
};

/// The new normal before it is made unit.
template <EdgeRule rule, class T>
inline Vector3<T> raw_normal(const Vector3<T>& e, const Vector3<T>& t, const Vector3<T>& m, const Vector3<T>& d) {
  if constexpr (rule == EdgeRule::convex_direction) {
    const Vector3<T> across = m.dot(m) * d - d.dot(m) * m;
    return t.cross(across);
  }
  return e.dot(t) * m - m.dot(t) * e;
}

/// Whether the raw normal of squared length `n2` is too short to be a direction.
template <class T>
inline bool is_degenerate(const T& n2, const T& squared) {
  const T least = T(kDegenerateNormal) * squared;
  return !(n2 > least * least) || !(n2 > T(1e-290));
}

template <class T>
inline Vec3 values_of(const Vector3<T>& x) {
  if constexpr (std::is_same_v<T, double>)
    return x;
  else
    return Vec3(x[0].a, x[1].a, x[2].a);
}

}  // namespace edge_detail

/// Point and unit normal of the new vertex. T is double, or a dual number with a member `a` (ceres::Jet).
template <EdgeRule rule, class T>
inline PointNormal<T> refine_edge(const Vector3<T>& p0, const Vector3<T>& n0, const Vector3<T>& p1,
                                  const Vector3<T>& n1, const Vector3<T>& d) {
  using std::sqrt;
  const edge_detail::EdgeTerms<rule, T> terms(p0, n0, p1, n1);
  const Vector3<T> m = terms.mean_normal(n0, n1);
  const Vector3<T> raw = edge_detail::raw_normal<rule, T>(terms.e, terms.tangent(), m, d);
  const T n2 = raw.dot(raw);
  PointNormal<T> result;
  result.p = terms.point(p0, p1);
  if (edge_detail::is_degenerate(n2, terms.squared)) {
    using edge_detail::values_of;
    result.n = fallback_normal(values_of<T>(terms.e), values_of<T>(m), values_of<T>(n0)).template cast<T>();
  } else {
    result.n = raw * (T(1) / sqrt(n2));
  }
  return result;
}

}  // namespace pellicle
