#include "click.h"

#include <algorithm>
#include <utility>

#include "pellicle/energies/profiles.h"
#include "pellicle/image/reorder.h"
#include "pellicle/mesh/distance.h"
#include "pellicle/raster/rasterize.h"
#include "sections.h"

namespace pellicle::bench {

Image<std::uint8_t> mask_of_labels(const Image<std::int32_t>& labels, const std::vector<int>& wanted) {
  Image<std::uint8_t> mask(labels.grid);
  for (std::size_t i = 0; i < mask.voxels.size(); ++i) {
    const int label = labels.voxels[i];
    const bool in = wanted.empty() ? label > 0 : std::find(wanted.begin(), wanted.end(), label) != wanted.end();
    mask.voxels[i] = in ? 1 : 0;
  }
  return in_lps_order(std::move(mask));
}

namespace {

template <class F>
void for_each_centre(const ImageGrid& grid, const F& visit) {
  std::size_t n = 0;
  for (int k = 0; k < grid.size[2]; ++k) {
    for (int j = 0; j < grid.size[1]; ++j) {
      for (int i = 0; i < grid.size[0]; ++i) visit(n++, grid.world_from_index(Vec3(i, j, k)));
    }
  }
}

}  // namespace

Vec3 deepest_point(const Image<std::uint8_t>& truth) {
  const TriangleMesh surface = surface_of_mask(truth);
  const ClosestPoint closest(surface);
  Vec3 place = Vec3::Zero();
  double depth = 0.0;
  for_each_centre(truth.grid, [&](std::size_t n, const Vec3& x) {
    if (truth.voxels[n] == 0) return;
    const double d = closest.query(x).distance;
    if (d <= depth) return;
    depth = d;
    place = x;
  });
  return place;
}

OverlapMetrics overlap_with(const Image<std::uint8_t>& truth, const Surface& surface) {
  return overlap_of(truth, rasterize_mask(measuring_mesh(surface, truth.grid.mean_spacing()), truth.grid));
}

double best_window_dice(const Image<float>& image, const Image<std::uint8_t>& truth) {
  const TriangleMesh surface = surface_of_mask(truth);
  const ClosestPoint closest(surface);
  std::vector<double> inside, around;
  for_each_centre(truth.grid, [&](std::size_t n, const Vec3& x) {
    const double value = static_cast<double>(image.voxels[n]);
    if (truth.voxels[n] != 0)
      inside.push_back(value);
    else if (closest.query(x, 5.0).triangle >= 0)
      around.push_back(value);
  });
  constexpr int kLevels = 60;
  std::vector<double> level, in, out;  // voxels of both kinds below each level
  std::sort(inside.begin(), inside.end());
  std::sort(around.begin(), around.end());
  const auto below = [](const std::vector<double>& sorted, double v) {
    return static_cast<double>(std::lower_bound(sorted.begin(), sorted.end(), v) - sorted.begin());
  };
  for (int q = 0; q <= kLevels; ++q) {
    const double v = q == kLevels ? inside.back() + 1.0 : quantile_of(inside, static_cast<double>(q) / kLevels);
    in.push_back(below(inside, v));
    out.push_back(below(around, v));
  }
  double best = 0.0;
  for (int lo = 0; lo < kLevels; ++lo) {
    for (int hi = lo + 1; hi <= kLevels; ++hi) {
      const auto a = static_cast<std::size_t>(lo), b = static_cast<std::size_t>(hi);
      const double hit = in[b] - in[a];
      best = std::max(best, 2.0 * hit / (static_cast<double>(inside.size()) + hit + out[b] - out[a]));
    }
  }
  return best;
}

}  // namespace pellicle::bench
