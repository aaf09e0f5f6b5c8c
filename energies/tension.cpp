#include "pellicle/energies/tension.h"

#include <array>
#include <cmath>
#include <numbers>

namespace pellicle {

VectorRows tension_rows(const SampleLayout& layout) {
  VectorRows rows;
  for (const auto& t : layout.triangles) {
    std::array<Vec3, 3> corner;
    for (std::size_t c = 0; c < 3; ++c) corner[c] = layout.reference[static_cast<std::size_t>(t[c])];
    const Vec3 along = (corner[1] - corner[0]).normalized();
    const Vec3 twice_area = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    const Vec3 normal = twice_area.normalized();
    // int |grad x|^2 = sum over facets of area |grad x|^2, the gradient of x constant in each; rows hold twice E.
    const double root = std::sqrt(2.0 * 0.5 * twice_area.norm() / (8.0 * std::numbers::pi));
    for (const Vec3& direction : {along, Vec3(normal.cross(along))}) {
      for (std::size_t c = 0; c < 3; ++c) {
        const Vec3 opposite = corner[(c + 2) % 3] - corner[(c + 1) % 3];
        rows.add(t[c], root * normal.cross(opposite).dot(direction) / twice_area.norm());
      }
      rows.close();
    }
  }
  return rows;
}

}  // namespace pellicle
