#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pellicle/base/errors.h"
#include "pellicle/base/parallel.h"
#include "pellicle/mesh/distance.h"
#include "pellicle/raster/rasterize.h"

namespace pellicle {

namespace {

constexpr int kBlock = 8;

struct Block {
  Index3 begin, end;
};

// Exact distances in one block. Most blocks end at the first query: from the centre of the block the whole of it is out
// of the band. Within a row the distance changes by no more than the step (it is 1-Lipschitz), so that each query
// starts from a tight bound.
void fill_block(const ClosestPoint& surface, const Image<std::uint8_t>& mask, const Block& block, double band,
                Image<float>& out) {
  const ImageGrid& grid = out.grid;
  const Vec3 lo(block.begin[0], block.begin[1], block.begin[2]);
  const Vec3 hi(block.end[0] - 1, block.end[1] - 1, block.end[2] - 1);
  const double reach = 0.5 * grid.spacing.cwiseProduct(hi - lo).norm();
  const bool near = surface.query(grid.world_from_index(0.5 * (lo + hi)), (band + reach) * (1.0 + 1e-9)).triangle >= 0;
  for (int k = block.begin[2]; k < block.end[2]; ++k) {
    for (int j = block.begin[1]; j < block.end[1]; ++j) {
      double bound = band;
      for (int i = block.begin[0]; i < block.end[0]; ++i) {
        double d = band;
        if (near) {
          const ClosestPoint::Hit hit = surface.query(grid.world_from_index(Vec3(i, j, k)), bound);
          if (hit.triangle >= 0) d = hit.distance;
          bound = std::min(band, (d + grid.spacing[0]) * (1.0 + 1e-9));
        }
        out.at(i, j, k) = static_cast<float>(mask.at(i, j, k) != 0 ? -d : d);
      }
    }
  }
}

}  // namespace

Image<float> rasterize_signed_distance(const TriangleMesh& surface, const ImageGrid& grid, double band_mm) {
  if (!(band_mm > 0.0)) throw UsageError(fmt::format("signed distance (band {} mm): it must be positive", band_mm));
  const Image<std::uint8_t> mask = rasterize_mask(surface, grid);
  const ClosestPoint closest(surface);
  Image<float> out(grid);
  Index3 blocks{};
  for (std::size_t a = 0; a < 3; ++a) blocks[a] = (grid.size[a] + kBlock - 1) / kBlock;
  const auto nx = static_cast<std::size_t>(blocks[0]), ny = static_cast<std::size_t>(blocks[1]);
  parallel_for(nx * ny * static_cast<std::size_t>(blocks[2]), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      const std::size_t at[3] = {b % nx, b / nx % ny, b / (nx * ny)};
      Block block{};
      for (std::size_t a = 0; a < 3; ++a) {
        block.begin[a] = static_cast<int>(at[a]) * kBlock;
        block.end[a] = std::min(block.begin[a] + kBlock, grid.size[a]);
      }
      fill_block(closest, mask, block, band_mm, out);
    }
  });
  return out;
}

}  // namespace pellicle
