#include "pellicle/mask/overlap.h"

#include "pellicle/base/errors.h"

namespace pellicle {

OverlapMetrics overlap_of(const Image<std::uint8_t>& truth, const Image<std::uint8_t>& result) {
  if (!same_grid(truth.grid, result.grid)) {
    throw BadData("overlap (masks): the two grids differ in size or place; resample one onto the other first");
  }
  std::size_t a = 0, b = 0, both = 0;
  for (std::size_t i = 0; i < truth.voxels.size(); ++i) {
    const bool in_a = truth.voxels[i] != 0, in_b = result.voxels[i] != 0;
    a += in_a ? 1 : 0;
    b += in_b ? 1 : 0;
    both += in_a && in_b ? 1 : 0;
  }
  OverlapMetrics m;
  m.truth_volume = static_cast<double>(a) * truth.grid.voxel_volume();
  m.result_volume = static_cast<double>(b) * result.grid.voxel_volume();
  if (a + b == 0) {
    m.dice = m.iou = 1.0;
  } else {
    m.dice = 2.0 * static_cast<double>(both) / static_cast<double>(a + b);
    m.iou = static_cast<double>(both) / static_cast<double>(a + b - both);
  }
  if (a > 0) {
    m.volume_error = (static_cast<double>(b) - static_cast<double>(a)) / static_cast<double>(a);
  } else if (b == 0) {
    m.volume_error = 0.0;
  }
  return m;
}

}  // namespace pellicle
