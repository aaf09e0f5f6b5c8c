#include "pellicle/job/fit_geometry.h"

#include <cmath>
#include <limits>

#include "pellicle/base/errors.h"

namespace pellicle {

namespace {

constexpr double kMostFacetsOfFit = 120000.0;

int level_for(const Surface& surface) {
  int level = 6;
  while (level > 2 && base_facets(surface.model) * std::pow(4.0, level) > kMostFacetsOfFit) --level;
  return level;
}

void measure(const GeometryFitOptions& options, GeometryFit& result) {
  const Surface& surface = result.sizes.best().fit.surface;
  result.mesh = tessellate(surface, options.mesh_level.value_or(level_for(surface)));
  for (const Vec3& v : result.mesh.vertices) {
    if (!v.allFinite()) throw Failure("fit failed (surface): it is not finite; please report this");
  }
  const bool closed = is_closed(surface.model);
  if (closed && volume_of(result.mesh) < 0.0) {
    for (auto& t : result.mesh.triangles) std::swap(t[1], t[2]);
    for (Vec3& n : result.mesh.normals) n = -n;
  }
  result.topology = topology_of(result.mesh);
  result.volume_ml = closed ? std::abs(volume_with_normals(tessellate(surface, level_for(surface)))) / 1000.0
                            : std::numeric_limits<double>::quiet_NaN();
  result.area_mm2 = area_of(result.mesh);
}

}  // namespace

GeometryFit fit_geometry(const GeometryInput& input, const GeometryFitOptions& options, const Observer& observer) {
  GeometryFit result;
  PhaseClock clock;
  clock.start("fit");
  result.sizes = search_size(input, options.sizes, observer);
  clock.start("measure");
  measure(options, result);
  clock.stop();
  result.seconds = clock.seconds();
  return result;
}

}  // namespace pellicle
