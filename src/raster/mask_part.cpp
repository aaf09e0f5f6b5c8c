#include "pellicle/raster/mask_part.h"

#include <algorithm>

#include "pellicle/base/errors.h"
#include "pellicle/raster/mask_morphology.h"

namespace pellicle {

Image<std::uint8_t> largest_part(const Image<std::uint8_t>& mask, int margin) {
  Image<std::uint8_t> whole(mask.grid);
  std::transform(mask.voxels.begin(), mask.voxels.end(), whole.voxels.begin(),
                 [](std::uint8_t v) { return static_cast<std::uint8_t>(v != 0 ? 1 : 0); });
  if (keep_largest(whole) == 0) throw BadData("the mask is empty");
  Index3 lo = mask.grid.size, hi{-1, -1, -1};
  const auto for_each_inside = [&](const auto& body) {
    std::size_t voxel = 0;
    for (int k = 0; k < mask.grid.size[2]; ++k) {
      for (int j = 0; j < mask.grid.size[1]; ++j) {
        for (int i = 0; i < mask.grid.size[0]; ++i, ++voxel) {
          if (whole.voxels[voxel] != 0) body(Index3{i, j, k});
        }
      }
    }
  };
  for_each_inside([&](const Index3& at) {
    for (std::size_t a = 0; a < 3; ++a) {
      lo[a] = std::min(lo[a], at[a]);
      hi[a] = std::max(hi[a], at[a]);
    }
  });
  ImageGrid grid = mask.grid;
  for (std::size_t a = 0; a < 3; ++a) grid.size[a] = hi[a] - lo[a] + 1 + 2 * margin;
  grid.origin_in_world = mask.grid.world_from_index(Vec3(lo[0] - margin, lo[1] - margin, lo[2] - margin));
  Image<std::uint8_t> part(grid);
  for_each_inside(
      [&](const Index3& at) { part.at(at[0] - lo[0] + margin, at[1] - lo[1] + margin, at[2] - lo[2] + margin) = 1; });
  return part;
}

}  // namespace pellicle
