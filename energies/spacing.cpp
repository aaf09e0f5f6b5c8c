#include "pellicle/energies/spacing.h"

#include <cmath>
#include <numbers>

#include "pellicle/energies/geometry.h"

namespace pellicle {

ScalarRows spacing_rows(const SampleView& surface, double energy_weight) {
  const SampleLayout& layout = surface.layout;
  const std::span<const Vec3> x = surface.x, normal = surface.normal;
  const double total = surface.total_area, held_area = surface.coarse_area();
  ScalarRows rows;
  for (std::size_t k = 0; k < surface.coarse_size(); ++k) {
    const std::size_t i = surface.coarse_sample(k);
    const double root = std::sqrt(2.0 * energy_weight * surface.area[i] / held_area);
    const Vec3 t1 = normal[i].unitOrthogonal();
    const Vec3 t2 = normal[i].cross(t1);
    for (const Vec3& t : {t1, t2}) {
      rows.add(static_cast<int>(i), root * t);
      rows.close(root * t.dot(x[i]));
    }
  }
  if (layout.reference.empty()) return rows;
  constexpr double kLeastFraction = 0.25;
  const double r2 = total / (4.0 * std::numbers::pi);
  const double scale = total / sum(sample_areas(layout, layout.reference));  // of areas on the reference shape
  const double root = std::sqrt(2.0 * energy_weight * r2 / static_cast<double>(layout.triangles.size()));
  for (const auto& t : layout.triangles) {
    const auto corner = [&](std::size_t c) { return static_cast<std::size_t>(t[c]); };
    const auto& on = layout.reference;
    const double reference = 0.5 * scale * (on[corner(1)] - on[corner(0)]).cross(on[corner(2)] - on[corner(0)]).norm();
    const Vec3 u = x[corner(1)] - x[corner(0)], v = x[corner(2)] - x[corner(0)];
    const Vec3 mean = (normal[corner(0)] + normal[corner(1)] + normal[corner(2)]).normalized();
    const double fraction = 0.5 * u.cross(v).dot(mean) / reference;
    if (!(fraction < kLeastFraction)) continue;
    // r = root (1/4 - fraction(x)), first order about the present x.
    const Vec3 du = -root * 0.5 / reference * v.cross(mean), dv = -root * 0.5 / reference * mean.cross(u);
    const Vec3 d0 = -(du + dv);
    rows.add(t[0], d0);
    rows.add(t[1], du);
    rows.add(t[2], dv);
    rows.close(d0.dot(x[corner(0)]) + du.dot(x[corner(1)]) + dv.dot(x[corner(2)]) - root * (kLeastFraction - fraction));
  }
  return rows;
}

}  // namespace pellicle
