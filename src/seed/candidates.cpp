#include <algorithm>
#include <array>
#include <cmath>

#include "pellicle/image/resample.h"
#include "pellicle/seed/components.h"
#include "pellicle/seed/seed.h"
#include "pellicle/seed/threshold.h"

namespace pellicle {

double threshold_of_two_classes(std::vector<float> values) {
  std::sort(values.begin(), values.end());
  const double lo = values[values.size() / 200], hi = values[values.size() - 1 - values.size() / 200];
  std::array<double, 256> histogram{};
  for (const float v : values) {
    const double bin = 255.0 * (std::clamp(static_cast<double>(v), lo, hi) - lo) / std::max(hi - lo, 1e-300);
    histogram[static_cast<std::size_t>(bin)] += 1.0;
  }
  double total = 0.0, weighted = 0.0;
  for (std::size_t b = 0; b < 256; ++b) {
    total += histogram[b];
    weighted += static_cast<double>(b) * histogram[b];
  }
  double below = 0.0, below_weighted = 0.0, best = -1.0, cut = 127.5;
  for (std::size_t b = 0; b < 255; ++b) {
    below += histogram[b];
    below_weighted += static_cast<double>(b) * histogram[b];
    if (below == 0.0 || below == total) continue;
    const double difference = below_weighted / below - (weighted - below_weighted) / (total - below);
    const double between = below * (total - below) * difference * difference;
    if (between > best) {
      best = between;
      cut = static_cast<double>(b) + 0.5;
    }
  }
  return lo + cut / 255.0 * (hi - lo);
}

std::vector<SeedSphere> find_candidates(const Image<float>& image) {
  const double longest = image.grid.extent().maxCoeff();
  const IndexBox whole{{0, 0, 0}, image.grid.size};
  Image<float> coarse = crop_and_bin(image, whole, bin_factors(image.grid, longest / 64.0));
  const double h = coarse.grid.mean_spacing();
  coarse = gaussian_smooth(std::move(coarse), h);
  const double threshold = threshold_of_two_classes(coarse.voxels);
  std::vector<SeedSphere> seeds;
  const auto total = static_cast<double>(coarse.voxels.size());
  for (const bool bright : {true, false}) {
    Image<std::uint8_t> mask(coarse.grid);
    for (std::size_t i = 0; i < mask.voxels.size(); ++i)
      mask.voxels[i] = (coarse.voxels[i] > threshold) == bright ? 1 : 0;
    int taken = 0;
    for (const Component& part : components_of(mask).parts) {
      const double share = static_cast<double>(part.voxels) / total;
      if (share > 0.6) continue;
      if (share < 1e-3 || taken == 2) break;
      seeds.push_back({part.deepest, part.depth});
      ++taken;
    }
  }
  const Vec3 middle =
      image.grid.world_from_index(0.5 * Vec3(image.grid.size[0] - 1, image.grid.size[1] - 1, image.grid.size[2] - 1));
  const double reach = 0.2 * image.grid.extent().minCoeff();
  const bool near_middle = std::any_of(seeds.begin(), seeds.end(),
                                       [&](const SeedSphere& s) { return (s.center - middle).norm() < 0.5 * reach; });
  if (!near_middle) seeds.push_back({middle, reach});
  return seeds;
}

}  // namespace pellicle
