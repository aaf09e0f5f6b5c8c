#include "pellicle/synthetic/box_fraction.h"

#include <algorithm>
#include <cmath>

namespace pellicle {

double box_fraction(double distance, const Vec3& normal, const Vec3& half) {
  Vec3 m = 2.0 * normal.cwiseAbs().cwiseProduct(half);
  const double reach = m.sum();
  if (distance >= 0.5 * reach) return 0.0;
  if (distance <= -0.5 * reach) return 1.0;
  m = (m / reach).cwiseMax(1e-6);
  m /= m.sum();
  double m1 = m.x(), m2 = m.y(), m3 = m.z();
  if (m1 > m2) std::swap(m1, m2);
  if (m2 > m3) std::swap(m2, m3);
  if (m1 > m2) std::swap(m1, m2);
  const double alpha = 0.5 - distance / reach;
  const double a = std::min(alpha, 1.0 - alpha);  // the smaller part; the other is its complement
  const double m12 = m1 + m2;
  const double six = 6.0 * m1 * m2 * m3;
  double volume = 0.0;
  if (a < m1) {
    volume = a * a * a / six;
  } else if (a < m2) {
    volume = a * (a - m1) / (2.0 * m2 * m3) + m1 * m1 / (6.0 * m2 * m3);
  } else if (a < std::min(m12, m3)) {
    volume = (a * a * (3.0 * m12 - a) + m1 * m1 * (m1 - 3.0 * a) + m2 * m2 * (m2 - 3.0 * a)) / six;
  } else if (m3 < m12) {
    volume =
        (a * a * (3.0 - 2.0 * a) + m1 * m1 * (m1 - 3.0 * a) + m2 * m2 * (m2 - 3.0 * a) + m3 * m3 * (m3 - 3.0 * a)) /
        six;
  } else {
    volume = (2.0 * a - m12) / (2.0 * m3);
  }
  return alpha <= 0.5 ? volume : 1.0 - volume;
}

}  // namespace pellicle
