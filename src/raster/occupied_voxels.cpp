#include "pellicle/raster/internal/occupied_voxels.h"

#include <cmath>

namespace pellicle {

Image<std::uint8_t> occupied_voxels(const std::vector<Vec3>& points, const Vec3& lo, const Vec3& hi, double h,
                                    int margin) {
  ImageGrid grid;
  grid.spacing = Vec3::Constant(h);
  for (int a = 0; a < 3; ++a) {
    grid.size[static_cast<std::size_t>(a)] = static_cast<int>(std::ceil((hi[a] - lo[a]) / h)) + 1 + 2 * margin;
  }
  grid.origin_in_world = lo - Vec3::Constant(margin * h);
  Image<std::uint8_t> mask(grid);
  for (const Vec3& x : points) {
    const Vec3 i = (x - grid.origin_in_world) / h;
    mask.at(static_cast<int>(std::lround(i.x())), static_cast<int>(std::lround(i.y())),
            static_cast<int>(std::lround(i.z()))) = 1;
  }
  return mask;
}

}  // namespace pellicle
