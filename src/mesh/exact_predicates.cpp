#include "pellicle/mesh/internal/exact_predicates.h"

#include <cmath>
#include <limits>

namespace pellicle {

namespace {

// A number as an unevaluated sum of doubles that do not overlap, smallest first: exact sums and products.
template <int N>
struct Expansion {
  std::array<double, N> term{};
  int size = 0;
  void push(double x) {
    if (x != 0.0) term[static_cast<std::size_t>(size++)] = x;
  }
  int sign() const {
    if (size == 0) return 0;
    return term[static_cast<std::size_t>(size - 1)] > 0.0 ? 1 : -1;
  }
};

struct TwoTerms {
  double high, low;
};

TwoTerms two_sum(double a, double b) {
  const double s = a + b, bb = s - a;
  return {s, (a - (s - bb)) + (b - bb)};
}

TwoTerms two_product(double a, double b) {
  const double p = a * b;
  return {p, std::fma(a, b, -p)};
}

Expansion<2> difference(double a, double b) {
  const TwoTerms d = two_sum(a, -b);
  Expansion<2> e;
  e.push(d.low);
  e.push(d.high);
  return e;
}

// Adds one double to an expansion (Shewchuk's grow-expansion): the result stays non-overlapping and exact.
template <int N>
void grow(Expansion<N>& e, double b) {
  Expansion<N> out;
  double q = b;
  for (int i = 0; i < e.size; ++i) {
    const TwoTerms s = two_sum(q, e.term[static_cast<std::size_t>(i)]);
    out.push(s.low);
    q = s.high;
  }
  out.push(q);
  e = out;
}

template <int N, int A, int B>
void add_product(Expansion<N>& sum, const Expansion<A>& a, const Expansion<B>& b, double sign) {
  for (int i = 0; i < a.size; ++i) {
    for (int j = 0; j < b.size; ++j) {
      const TwoTerms p = two_product(sign * a.term[static_cast<std::size_t>(i)], b.term[static_cast<std::size_t>(j)]);
      grow(sum, p.low);
      grow(sum, p.high);
    }
  }
}

int exact_orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  std::array<std::array<Expansion<2>, 3>, 3> m;
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    m[0][i] = difference(a[axis], d[axis]);
    m[1][i] = difference(b[axis], d[axis]);
    m[2][i] = difference(c[axis], d[axis]);
  }
  Expansion<256> determinant;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    Expansion<20> minor;
    add_product(minor, m[1][j], m[2][k], 1.0);
    add_product(minor, m[1][k], m[2][j], -1.0);
    add_product(determinant, m[0][i], minor, 1.0);
  }
  return determinant.sign();
}

int exact_orientation_2d(double ax, double ay, double bx, double by, double cx, double cy) {
  Expansion<20> determinant;
  add_product(determinant, difference(ax, cx), difference(by, cy), 1.0);
  add_product(determinant, difference(ay, cy), difference(bx, cx), -1.0);
  return determinant.sign();
}

int sign_of(double x) {
  return x > 0.0 ? 1 : x < 0.0 ? -1 : 0;
}

constexpr double kUnit = std::numeric_limits<double>::epsilon();  // twice the unit round-off: generous bounds below

bool inside_2d(const Vec3& p, const std::array<Vec3, 3>& t, int drop) {
  const int s0 = orientation_2d(t[0], t[1], p, drop);
  const int s1 = orientation_2d(t[1], t[2], p, drop);
  const int s2 = orientation_2d(t[2], t[0], p, drop);
  return (s0 >= 0 && s1 >= 0 && s2 >= 0) || (s0 <= 0 && s1 <= 0 && s2 <= 0);
}

// On a common line: whether r lies in the box of pq, seen along `drop`.
bool within(const Vec3& p, const Vec3& q, const Vec3& r, int drop) {
  for (int axis = 0; axis < 3; ++axis) {
    if (axis == drop) continue;
    if (r[axis] < std::min(p[axis], q[axis]) || r[axis] > std::max(p[axis], q[axis])) return false;
  }
  return true;
}

bool segments_meet_2d(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s, int drop) {
  const int d0 = orientation_2d(p, q, r, drop), d1 = orientation_2d(p, q, s, drop);
  const int d2 = orientation_2d(r, s, p, drop), d3 = orientation_2d(r, s, q, drop);
  if (d0 * d1 < 0 && d2 * d3 < 0) return true;
  return (d0 == 0 && within(p, q, r, drop)) || (d1 == 0 && within(p, q, s, drop)) ||
         (d2 == 0 && within(r, s, p, drop)) || (d3 == 0 && within(r, s, q, drop));
}

bool coplanar_segment_meets(const Vec3& p, const Vec3& q, const std::array<Vec3, 3>& t) {
  for (int drop = 0; drop < 3; ++drop) {
    if (orientation_2d(t[0], t[1], t[2], drop) == 0) continue;  // the projection must keep the triangle's area
    return inside_2d(p, t, drop) || inside_2d(q, t, drop) || segments_meet_2d(p, q, t[0], t[1], drop) ||
           segments_meet_2d(p, q, t[1], t[2], drop) || segments_meet_2d(p, q, t[2], t[0], drop);
  }
  return false;
}

}  // namespace

int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = a - d, v = b - d, w = c - d;
  const double m0 = v.y() * w.z() - v.z() * w.y();
  const double m1 = v.z() * w.x() - v.x() * w.z();
  const double m2 = v.x() * w.y() - v.y() * w.x();
  const double determinant = u.x() * m0 + u.y() * m1 + u.z() * m2;
  const double permanent = std::abs(u.x()) * (std::abs(v.y() * w.z()) + std::abs(v.z() * w.y())) +
                           std::abs(u.y()) * (std::abs(v.z() * w.x()) + std::abs(v.x() * w.z())) +
                           std::abs(u.z()) * (std::abs(v.x() * w.y()) + std::abs(v.y() * w.x()));
  if (std::abs(determinant) > 8.0 * kUnit * permanent) return sign_of(determinant);
  return exact_orientation(a, b, c, d);
}

int orientation_2d(const Vec3& a, const Vec3& b, const Vec3& c, int drop) {
  const int x = (drop + 1) % 3, y = (drop + 2) % 3;
  const double left = (a[x] - c[x]) * (b[y] - c[y]), right = (a[y] - c[y]) * (b[x] - c[x]);
  const double determinant = left - right;
  if (std::abs(determinant) > 4.0 * kUnit * (std::abs(left) + std::abs(right))) return sign_of(determinant);
  return exact_orientation_2d(a[x], a[y], b[x], b[y], c[x], c[y]);
}

bool segment_meets_triangle(const Vec3& p, const Vec3& q, const std::array<Vec3, 3>& t) {
  const int side_p = orientation(t[0], t[1], t[2], p), side_q = orientation(t[0], t[1], t[2], q);
  if (side_p * side_q > 0) return false;
  if (side_p == 0 && side_q == 0) return coplanar_segment_meets(p, q, t);
  const int s0 = orientation(p, q, t[0], t[1]);
  const int s1 = orientation(p, q, t[1], t[2]);
  if (s0 * s1 < 0) return false;
  const int s2 = orientation(p, q, t[2], t[0]);
  return s0 * s2 >= 0 && s1 * s2 >= 0;
}

bool triangles_meet(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
  // Most candidates lie wholly on one side of the other's plane.
  const auto apart = [](const std::array<Vec3, 3>& plane, const std::array<Vec3, 3>& t) {
    const int s = orientation(plane[0], plane[1], plane[2], t[0]);
    return s != 0 && s == orientation(plane[0], plane[1], plane[2], t[1]) &&
           s == orientation(plane[0], plane[1], plane[2], t[2]);
  };
  if (apart(a, b) || apart(b, a)) return false;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    if (segment_meets_triangle(a[i], a[j], b) || segment_meets_triangle(b[i], b[j], a)) return true;
  }
  return false;
}

}  // namespace pellicle
