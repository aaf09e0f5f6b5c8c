#include <algorithm>
#include <cmath>

#include "pellicle/image/resample.h"
#include "pellicle/mask/components.h"
#include "pellicle/seed/seed.h"
#include "pellicle/seed/threshold.h"

namespace pellicle {

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
      const double fraction = static_cast<double>(part.voxels) / total;
      if (fraction > 0.6) continue;
      if (fraction < 1e-3 || taken == 2) break;
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
