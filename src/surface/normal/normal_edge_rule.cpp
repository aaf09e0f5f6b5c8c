#include "pellicle/surface/normal/internal/normal_edge_rule.h"

namespace pellicle {
namespace {

using namespace edge_detail;  // NOLINT(google-build-using-namespace)

/// w0 with respect to s0 and s1.
struct WeightSlope {
  double s0 = 0, s1 = 0;
};

template <EdgeRule rule>
WeightSlope weight_slope(double s0, double s1) {
  if constexpr (rule == EdgeRule::balanced) return {};
  if constexpr (rule == EdgeRule::published) {
    const double sum = std::abs(s0) + std::abs(s1);
    if (sum < 1e-14) return {};
    return {-std::abs(s1) * (s0 < 0 ? -1.0 : 1.0) / (sum * sum), std::abs(s0) * (s1 < 0 ? -1.0 : 1.0) / (sum * sum)};
  }
  const double x = s0 * s1;
  if (!(x > kLeastConvexity)) return {};
  constexpr double delta2 = kConvexScale * kConvexScale;
  const double sum = s0 + s1;
  const double inverse = 1 / (sum * (x * x + delta2));
  const double blend = x * x * sum * inverse;  // S(x)
  const double r = (s1 - s0) / sum;
  const double k = 2 * x * delta2 * sum * sum * inverse * inverse * r;  // r S'(x)
  const double over = 2 * blend / (sum * sum);
  return {0.5 * (k - over) * s1, 0.5 * (k + over) * s0};
}

/// dG/dz; G is `handle_factor(z)`.
template <EdgeRule rule>
double handle_slope(double z, double G) {
  if constexpr (rule == EdgeRule::published) {
    if (z < kPublishedSteep) return 0;
  } else if (z < kSteep) {
    return kG1 + kG2 * (z - kSteep);
  }
  return -(0.5 / std::sqrt(z) + 1) * G * G;
}

double binormal_slope(double z) {
  return z < kPublishedSteep ? 0 : -0.5 / (z * std::sqrt(z));
}

/// Derivatives of the handle lengths g0, g1 by the signed sines.
struct HandleSlopes {
  double g0_s0, g0_s1, g1_s0, g1_s1;
};

template <EdgeRule rule>
HandleSlopes handle_slopes(const EdgeTerms<rule, double>& k) {
  const WeightSlope w = weight_slope<rule>(k.s0, k.s1);
  return {4 * k.G0 * w.s0 - 8 * k.w0 * k.s0 * handle_slope<rule>(k.z0, k.G0), 4 * k.G0 * w.s1, -4 * k.G1 * w.s0,
          -4 * k.G1 * w.s1 - 8 * (1 - k.w0) * k.s1 * handle_slope<rule>(k.z1, k.G1)};
}

Mat3 cross_matrix(const Vec3& v) {
  Mat3 result;
  result << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return result;
}

/// The handles' derivatives, h_i = g_i t_i.
struct HandleDerivatives {
  Mat3 h0_e, h0_n0, h0_n1, h1_e, h1_n0, h1_n1;
};

template <EdgeRule rule>
HandleDerivatives handle_derivatives(const EdgeTerms<rule, double>& k, const EdgeEnds& in, const Vec3& s0_e,
                                     const Vec3& s1_e) {
  const HandleSlopes g = handle_slopes<rule>(k);
  HandleDerivatives h;
  const Vec3 g0_e = g.g0_s0 * s0_e + g.g0_s1 * s1_e, g1_e = g.g1_s0 * s0_e + g.g1_s1 * s1_e;
  h.h0_e = k.t0 * g0_e.transpose() - (k.g0 * in.n0) * in.n0.transpose();
  h.h0_e.diagonal().array() += k.g0;
  h.h1_e = k.t1 * g1_e.transpose() - (k.g1 * in.n1) * in.n1.transpose();
  h.h1_e.diagonal().array() += k.g1;
  const Vec3 unit = k.inverse * k.e;  // ds0/dn0 = -unit, ds1/dn1 = unit
  h.h0_n0 = -(k.g0 * in.n0) * k.e.transpose() - (g.g0_s0 * k.t0) * unit.transpose();
  h.h0_n0.diagonal().array() -= k.g0 * k.a0;
  h.h0_n1 = (g.g0_s1 * k.t0) * unit.transpose();
  h.h1_n0 = -(g.g1_s0 * k.t1) * unit.transpose();
  h.h1_n1 = (g.g1_s1 * k.t1) * unit.transpose() - (k.g1 * in.n1) * k.e.transpose();
  h.h1_n1.diagonal().array() -= k.g1 * k.a1;
  return h;
}

}  // namespace

Vec3 fallback_normal(const Vec3& e, const Vec3& m, const Vec3& n0) {
  const double length = e.norm();
  const Vec3 direction = length > 1e-140 ? Vec3(e / length) : Vec3(Vec3::Zero());
  for (const Vec3& wish : {m, n0}) {
    const Vec3 across = wish - wish.dot(direction) * direction;
    const double norm = across.norm();
    if (norm > 1e-6 * wish.norm()) return across / norm;
  }
  int axis = 0;
  direction.cwiseAbs().minCoeff(&axis);
  const Vec3 across = Vec3::Unit(axis) - direction[axis] * direction;
  return across.normalized();
}

template <EdgeRule rule, bool with_normal>
void differentiate_edge(const EdgeEnds& in, PointNormal<double>& value, EdgeDerivative& derivative) {
  const EdgeTerms<rule, double> k(in.p0, in.n0, in.p1, in.n1);
  const Vec3 along = k.e / k.squared;
  const Vec3 s0_e = -k.inverse * in.n0 - k.s0 * along, s1_e = k.inverse * in.n1 - k.s1 * along;
  const HandleDerivatives h = handle_derivatives<rule>(k, in, s0_e, s1_e);
  value.p = k.point(in.p0, in.p1);
  derivative.p_e = 0.125 * (h.h0_e - h.h1_e);
  derivative.p_n0 = 0.125 * (h.h0_n0 - h.h1_n0);
  derivative.p_n1 = 0.125 * (h.h0_n1 - h.h1_n1);
  if constexpr (with_normal) {
    constexpr double a = chord_factor<rule>, b = 0.5 * (a - 1);
    const Vec3 t = k.tangent(), m = k.mean_normal(in.n0, in.n1);
    const Vec3 raw = raw_normal<rule, double>(k.e, t, m, in.d);
    const double n2 = raw.squaredNorm();
    if (is_degenerate(n2, k.squared)) {
      value.n = fallback_normal(k.e, m, in.n0);
      derivative.n_e.setZero();
      derivative.n_n0.setZero();
      derivative.n_n1.setZero();
      derivative.n_d.setZero();
      return;
    }
    const double inverse = 1 / std::sqrt(n2);
    value.n = inverse * raw;
    Mat3 project = -(inverse * value.n) * value.n.transpose();  // d unit(N) / dN
    project.diagonal().array() += inverse;

    Mat3 t_e = -b * (h.h0_e + h.h1_e);
    t_e.diagonal().array() += a;
    const Mat3 t_n0 = -b * (h.h0_n0 + h.h1_n0), t_n1 = -b * (h.h0_n1 + h.h1_n1);
    if constexpr (rule == EdgeRule::convex_direction) {
      const double mm = m.squaredNorm(), dm = in.d.dot(m);
      const Vec3 across = mm * in.d - dm * m;
      const Mat3 by_t = project * cross_matrix(-across), by_across = project * cross_matrix(t);
      Mat3 across_m = (2 * in.d) * m.transpose() - m * in.d.transpose();
      across_m.diagonal().array() -= dm;
      Mat3 across_d = -m * m.transpose();
      across_d.diagonal().array() += mm;
      const Mat3 by_m = by_across * across_m;
      derivative.n_e.noalias() = by_t * t_e;
      derivative.n_n0 = by_m + by_t * t_n0;
      derivative.n_n1 = by_m + by_t * t_n1;
      derivative.n_d.noalias() = by_across * across_d;
    } else {
      const double et = k.e.dot(t), mt = m.dot(t);
      const Vec3 pm = project * m, pe = project * k.e;
      const Mat3 by_t = pm * k.e.transpose() - pe * m.transpose();
      const Mat3 by_m = et * project - pe * t.transpose();
      const Mat3 by_e = pm * t.transpose() - mt * project;
      derivative.n_e = by_e + by_t * t_e;
      if constexpr (rule == EdgeRule::published) {
        const double b0 = binormal_factor(k.z0), b1 = binormal_factor(k.z1);
        const Vec3 m_s0 = (-2 * k.s0 * binormal_slope(k.z0)) * (by_m * in.n0);
        const Vec3 m_s1 = (-2 * k.s1 * binormal_slope(k.z1)) * (by_m * in.n1);
        derivative.n_e += m_s0 * s0_e.transpose() + m_s1 * s1_e.transpose();
        derivative.n_n0 = b0 * by_m - (k.inverse * m_s0) * k.e.transpose() + by_t * t_n0;
        derivative.n_n1 = b1 * by_m + (k.inverse * m_s1) * k.e.transpose() + by_t * t_n1;
      } else {
        derivative.n_n0 = by_m + by_t * t_n0;
        derivative.n_n1 = by_m + by_t * t_n1;
      }
      derivative.n_d.setZero();
    }
  }
}

template <EdgeRule rule, bool with_normal>
void pull_back_edge(const EdgeEnds& in, const Vec3& bar_p, const Vec3& bar_n, const EdgeCotangents& bars) {
  const EdgeTerms<rule, double> k(in.p0, in.n0, in.p1, in.n1);
  constexpr double a = chord_factor<rule>, b = 0.5 * (a - 1);
  Vec3 bar_e = Vec3::Zero(), bar_h0 = 0.125 * bar_p, bar_h1 = -0.125 * bar_p;
  double bar_s0 = 0, bar_s1 = 0;
  if constexpr (with_normal) {
    const Vec3 t = k.tangent(), m = k.mean_normal(in.n0, in.n1);
    const Vec3 raw = raw_normal<rule, double>(k.e, t, m, in.d);
    const double n2 = raw.squaredNorm();
    if (!is_degenerate(n2, k.squared)) {
      const double inverse = 1 / std::sqrt(n2);
      const Vec3 n = inverse * raw, bar_raw = inverse * (bar_n - n.dot(bar_n) * n);
      Vec3 bar_t, bar_m;
      if constexpr (rule == EdgeRule::convex_direction) {
        const double mm = m.squaredNorm(), dm = in.d.dot(m);
        const Vec3 across = mm * in.d - dm * m, bar_across = bar_raw.cross(t);
        const double bar_mm = bar_across.dot(in.d), bar_dm = -bar_across.dot(m);
        bar_t = across.cross(bar_raw);
        bar_m = 2 * bar_mm * m + bar_dm * in.d - dm * bar_across;
        bars.d += mm * bar_across + bar_dm * m;
      } else {
        const double et = k.e.dot(t), mt = m.dot(t), bar_et = bar_raw.dot(m), bar_mt = -bar_raw.dot(k.e);
        bar_t = bar_et * k.e + bar_mt * m;
        bar_m = et * bar_raw + bar_mt * t;
        bar_e = bar_et * t - mt * bar_raw;
      }
      if constexpr (rule == EdgeRule::published) {
        bars.n0 += binormal_factor(k.z0) * bar_m;
        bars.n1 += binormal_factor(k.z1) * bar_m;
        bar_s0 = -2 * k.s0 * binormal_slope(k.z0) * in.n0.dot(bar_m);
        bar_s1 = -2 * k.s1 * binormal_slope(k.z1) * in.n1.dot(bar_m);
      } else {
        bars.n0 += bar_m;
        bars.n1 += bar_m;
      }
      bar_e += a * bar_t;
      bar_h0 -= b * bar_t;
      bar_h1 -= b * bar_t;
    }
  }
  const HandleSlopes g = handle_slopes<rule>(k);
  const double bar_g0 = bar_h0.dot(k.t0), bar_g1 = bar_h1.dot(k.t1);
  bar_s0 += g.g0_s0 * bar_g0 + g.g1_s0 * bar_g1;
  bar_s1 += g.g0_s1 * bar_g0 + g.g1_s1 * bar_g1;
  const Vec3 bar_t0 = k.g0 * bar_h0, bar_t1 = k.g1 * bar_h1;
  const double bar_a0 = -in.n0.dot(bar_t0) - k.inverse * bar_s0, bar_a1 = -in.n1.dot(bar_t1) + k.inverse * bar_s1;
  const double stretch = (k.s0 * bar_s0 + k.s1 * bar_s1) / k.squared;
  bar_e += bar_t0 + bar_t1 + bar_a0 * in.n0 + bar_a1 * in.n1 - stretch * k.e;
  bars.n0 += bar_a0 * k.e - k.a0 * bar_t0;
  bars.n1 += bar_a1 * k.e - k.a1 * bar_t1;
  bars.p0 += 0.5 * bar_p - bar_e;
  bars.p1 += 0.5 * bar_p + bar_e;
}

#define PELLICLE_EDGE_RULE(rule)                                                                              \
  template void differentiate_edge<rule, true>(const EdgeEnds&, PointNormal<double>&, EdgeDerivative&);       \
  template void differentiate_edge<rule, false>(const EdgeEnds&, PointNormal<double>&, EdgeDerivative&);      \
  template void pull_back_edge<rule, true>(const EdgeEnds&, const Vec3&, const Vec3&, const EdgeCotangents&); \
  template void pull_back_edge<rule, false>(const EdgeEnds&, const Vec3&, const Vec3&, const EdgeCotangents&)
PELLICLE_EDGE_RULE(EdgeRule::convex);
PELLICLE_EDGE_RULE(EdgeRule::convex_direction);
PELLICLE_EDGE_RULE(EdgeRule::balanced);
PELLICLE_EDGE_RULE(EdgeRule::published);
#undef PELLICLE_EDGE_RULE

}  // namespace pellicle
