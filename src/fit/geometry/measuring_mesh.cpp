#include "pellicle/fit/geometry/measuring_mesh.h"

#include <algorithm>
#include <cmath>

namespace pellicle {

int measuring_level(const SurfaceModel& model) {
  const auto facets = [&](int level) { return base_facets(model) * std::pow(4.0, level); };
  int level = 2;
  while (facets(level) < std::max(10000.0, 30.0 * control_point_count(model)) && facets(level + 1) < 250000.0) ++level;
  return level;
}

TriangleMesh measuring_mesh(const Surface& surface) {
  return tessellate(surface, measuring_level(surface.model));
}

}  // namespace pellicle
