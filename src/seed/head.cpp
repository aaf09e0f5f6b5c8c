#include <algorithm>
#include <cmath>
#include <numbers>

#include "pellicle/base/errors.h"
#include "pellicle/image/resample.h"
#include "pellicle/seed/head.h"

namespace pellicle {

namespace {

float quantile(std::vector<float>& values, double fraction) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

HeadReading read_head(const Image<float>& image) {
  // 2 mm is plenty for the statistics of a head, and takes the noise out of them.
  const IndexBox whole{{0, 0, 0}, image.grid.size};
  const Image<float> coarse = gaussian_smooth(crop_and_bin(image, whole, bin_factors(image.grid, 2.0)), 1.0);
  std::vector<float> sorted = coarse.voxels;
  HeadReading reading;
  reading.levels.low = quantile(sorted, 0.02);
  const double high = quantile(sorted, 0.98);
  if (!(high > reading.levels.low)) {
    throw BadData("no object to be found: the volume has no contrast between its 2nd and 98th percentile; give a seed");
  }
  reading.levels.threshold = reading.levels.low + 0.1 * (high - reading.levels.low);
  Vec3 moment = Vec3::Zero();
  double mass = 0.0;
  std::size_t count = 0;
  const ImageGrid& grid = coarse.grid;
  const auto for_each = [&](const auto& visit) {
    for (int k = 0; k < grid.size[2]; ++k) {
      for (int j = 0; j < grid.size[1]; ++j) {
        for (int i = 0; i < grid.size[0]; ++i) visit(grid.world_from_index(Vec3(i, j, k)), coarse.at(i, j, k));
      }
    }
  };
  for_each([&](const Vec3& x, double v) {
    if (v <= reading.levels.threshold) return;
    const double w = std::min(v, high) - reading.levels.low;
    moment += w * x;
    mass += w;
    ++count;
  });
  reading.center = moment / mass;
  reading.head_radius = std::cbrt(3.0 * static_cast<double>(count) * grid.voxel_volume() / (4.0 * std::numbers::pi));
  std::vector<float> tissue;
  for_each([&](const Vec3& x, float v) {
    if (v > reading.levels.low && v < high && (x - reading.center).norm() <= reading.head_radius) tissue.push_back(v);
  });
  reading.levels.middle = tissue.empty() ? high : quantile(tissue, 0.5);
  return reading;
}

SeedSphere find_head(const Image<float>& image) {
  const HeadReading reading = read_head(image);
  return {reading.center, 0.5 * reading.head_radius};
}

}  // namespace pellicle
