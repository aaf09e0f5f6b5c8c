#pragma once
/// The stretch energy of a map from the sphere to a surface, as one vertex on the sphere sees it.

#include <limits>
#include <vector>

#include "pellicle/base/geometry.h"

namespace pellicle {

/// A triangle seen from the vertex that moves: the other two corners in order.
struct Wedge {
  Vec3 a, b, cross;  ///< cross = a x b: det = cross . p
  double area, p2, a2, b2;
  double dirichlet;  ///< factor of N in the energy of the inverse map
};

/// Stretch of the triangles around p. E_T = A N/(2 D^2), D = det(p, a, b), N = sum of (cosine terms at a corner) x
/// (opposite side)^2: twice the Dirichlet energy of the map over the domain's area, with D/2 for that area.
class Star {
 public:
  std::vector<Wedge> wedges;

  double energy(const Vec3& p) const {
    double total = 0.0;
    for (const Wedge& w : wedges) {
      const double D = w.cross.dot(p);
      if (!(D > kLeast)) return std::numeric_limits<double>::infinity();
      total += numerator(w, p) * (w.area / (2.0 * D * D) + w.dirichlet);
    }
    return total;
  }

  /// Gradient and Hessian by p as a free vector.
  void differentiate(const Vec3& p, Vec3& gradient, Mat3& hessian) const {
    gradient.setZero();
    hessian.setZero();
    for (const Wedge& w : wedges) {
      const double D = w.cross.dot(p), N = numerator(w, p), c = 0.5 * w.area / (D * D);
      const Vec3 dN = w.p2 * (2.0 * p - w.a - w.b) + w.a2 * (w.b - w.a) + w.b2 * (w.a - w.b);
      gradient += c * (dN - 2.0 * N / D * w.cross) + w.dirichlet * dN;
      hessian += 2.0 * w.dirichlet * w.p2 * Mat3::Identity();
      hessian += c * (2.0 * w.p2 * Mat3::Identity() - 2.0 / D * (dN * w.cross.transpose() + w.cross * dN.transpose()) +
                      6.0 * N / (D * D) * w.cross * w.cross.transpose());
    }
  }

 private:
  static constexpr double kLeast = 1e-14;
  static double numerator(const Wedge& w, const Vec3& p) {
    return w.p2 * (w.a - p).dot(w.b - p) + w.a2 * (w.b - w.a).dot(p - w.a) + w.b2 * (p - w.b).dot(w.a - w.b);
  }
};

}  // namespace pellicle
