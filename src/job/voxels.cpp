#include "pellicle/job/voxels.h"

#include <algorithm>
#include <cmath>

#include "pellicle/raster/rasterize.h"

namespace pellicle {

Image<float> signed_distance(const Surface& surface, const TriangleMesh& mesh, const ImageGrid& grid) {
  constexpr int far_facets = 2500;
  const double band = 10.0 * grid.mean_spacing();
  Image<float> near = rasterize_signed_distance(mesh, grid, band);
  const int control_facets = base_facets(surface.model);
  int level = 2;
  while ((control_facets << (2 * (level + 1))) <= far_facets) ++level;
  const Image<float> far = rasterize_signed_distance(tessellate(surface, level), grid, grid.extent().norm());
  for (std::size_t i = 0; i < near.voxels.size(); ++i) {
    float& value = near.voxels[i];
    if (std::abs(value) < static_cast<float>(band)) continue;
    value = std::copysign(std::max(static_cast<float>(band), std::abs(far.voxels[i])), value);
  }
  return near;
}

}  // namespace pellicle
