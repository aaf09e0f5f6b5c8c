#pragma once
/// floor: keeps a surface on one side of a plane, such as the bottom of a dish. E = w sum_i (A_i/A) max(0, d_i)^2 in
/// mm^2, d_i how far sample i lies beyond the plane, A_i its area, A their sum. A sphere of radius R whose centre lies
/// on the plane has E = w R^2/6.

#include <cmath>

#include "pellicle/energies/energy_kind.h"
#include "pellicle/energies/term.h"

namespace pellicle {

/// Points x with normal . (x - point) > 0 are beyond.
struct Plane {
  Vec3 point;   ///< LPS mm
  Vec3 normal;  ///< of length 1, towards the forbidden side
};

/// A row r = root (normal . x_i - normal . point) for every sample that is beyond now. Rows hold twice E, because half
/// their sum of squares is the energy.
inline ScalarRows floor_rows(const SampleView& surface, const Plane& plane, double weight) {
  ScalarRows rows;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (plane.normal.dot(surface.x[i] - plane.point) <= 0.0) continue;
    const double root = std::sqrt(2.0 * weight * surface.area[i] / surface.total_area);
    rows.add(static_cast<int>(i), root * plane.normal);
    rows.close(root * plane.normal.dot(plane.point));
  }
  return rows;
}

/// What a stage asks in each step. The plane is the axial one through the origin, and the forbidden side is below it.
struct FloorTerm {
  TermOutput operator()(const StepView& step) const { return {floor_rows(step.surface, plane, step.weight)}; }

  Plane plane{Vec3(0, 0, 0), Vec3(0, 0, -1)};
};

}  // namespace pellicle
