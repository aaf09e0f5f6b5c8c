#include "otsu_baseline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "pellicle/base/errors.h"

namespace pellicle::bench {
namespace {

/// 6-connected components of the voxels whose class is `wanted`: label per voxel (-1: other class), and sizes.
struct ClassComponents {
  std::vector<int> label;
  std::vector<std::size_t> size;

  int largest() const { return static_cast<int>(std::max_element(size.begin(), size.end()) - size.begin()); }
};

ClassComponents class_components_of(const ImageGrid& grid, const std::vector<std::uint8_t>& voxel_class,
                                    std::uint8_t wanted) {
  ClassComponents result;
  result.label.assign(voxel_class.size(), -1);
  const auto nx = static_cast<std::size_t>(grid.size[0]), ny = static_cast<std::size_t>(grid.size[1]);
  const auto nz = static_cast<std::size_t>(grid.size[2]);
  std::vector<std::size_t> front;
  for (std::size_t start = 0; start < voxel_class.size(); ++start) {
    if (voxel_class[start] != wanted || result.label[start] >= 0) continue;
    const int label = static_cast<int>(result.size.size());
    result.size.push_back(0);
    result.label[start] = label;
    front.assign(1, start);
    const auto visit = [&](std::size_t n) {
      if (voxel_class[n] != wanted || result.label[n] >= 0) return;
      result.label[n] = label;
      front.push_back(n);
    };
    while (!front.empty()) {
      const std::size_t n = front.back();
      front.pop_back();
      ++result.size.back();
      const std::size_t i = n % nx, j = n / nx % ny, k = n / (nx * ny);
      if (i > 0) visit(n - 1);
      if (i + 1 < nx) visit(n + 1);
      if (j > 0) visit(n - nx);
      if (j + 1 < ny) visit(n + nx);
      if (k > 0) visit(n - nx * ny);
      if (k + 1 < nz) visit(n + nx * ny);
    }
  }
  return result;
}

/// The voxels of the 3 x 3 x 3 block around the seed that lie in the volume.
std::vector<std::size_t> around(const ImageGrid& grid, const Vec3& seed_in_world) {
  if (!grid.contains(seed_in_world)) throw BadData("baseline seed outside the volume (otsu_baseline)");
  const Vec3 x = grid.index_from_world(seed_in_world);
  std::vector<std::size_t> voxels;
  for (int k = -1; k <= 1; ++k) {
    for (int j = -1; j <= 1; ++j) {
      for (int i = -1; i <= 1; ++i) {
        const Index3 v{static_cast<int>(std::lround(x.x())) + i, static_cast<int>(std::lround(x.y())) + j,
                       static_cast<int>(std::lround(x.z())) + k};
        bool inside = true;
        for (std::size_t a = 0; a < 3; ++a) inside = inside && v[a] >= 0 && v[a] < grid.size[a];
        if (inside) voxels.push_back(grid.offset(v[0], v[1], v[2]));
      }
    }
  }
  return voxels;
}

/// Fills what cannot be reached from the border of the volume.
void fill_holes(Image<std::uint8_t>& mask) {
  const ClassComponents background = class_components_of(mask.grid, mask.voxels, 0);
  std::vector<bool> open(background.size.size(), false);
  const Index3& size = mask.grid.size;
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i) {
        const bool border = i == 0 || j == 0 || k == 0 || i + 1 == size[0] || j + 1 == size[1] || k + 1 == size[2];
        const int label = background.label[mask.grid.offset(i, j, k)];
        if (border && label >= 0) open[static_cast<std::size_t>(label)] = true;
      }
    }
  }
  for (std::size_t n = 0; n < mask.voxels.size(); ++n) {
    if (background.label[n] >= 0 && !open[static_cast<std::size_t>(background.label[n])]) mask.voxels[n] = 1;
  }
}

}  // namespace

double otsu_threshold(const Image<float>& image) {
  constexpr int kBins = 512;
  const auto [low_it, high_it] = std::minmax_element(image.voxels.begin(), image.voxels.end());
  const double low = *low_it, width = (static_cast<double>(*high_it) - low) / kBins;
  if (!(width > 0.0)) return low;
  std::array<double, kBins> count{};
  double total_moment = 0.0;
  for (const float value : image.voxels) {
    const int bin = std::min(kBins - 1, static_cast<int>((value - low) / width));
    count[static_cast<std::size_t>(bin)] += 1.0;
    total_moment += bin;
  }
  const auto total = static_cast<double>(image.voxels.size());
  double below = 0.0, moment = 0.0, best = -1.0, first = 0.0, last = 0.0;
  for (int bin = 0; bin + 1 < kBins; ++bin) {
    below += count[static_cast<std::size_t>(bin)];
    moment += bin * count[static_cast<std::size_t>(bin)];
    const double above = total - below;
    if (below <= 0.0 || above <= 0.0) continue;
    const double gap = moment / below - (total_moment - moment) / above;
    const double between = below * above * gap * gap;
    if (between > best) {
      best = between;
      first = bin;
    }
    if (between >= best) last = bin;
  }
  return low + width * (0.5 * (first + last) + 1.0);
}

Image<std::uint8_t> otsu_baseline(const Image<float>& image, const Vec3& seed_in_world, OtsuObject object) {
  const double threshold = otsu_threshold(image);
  std::vector<std::uint8_t> bright(image.voxels.size());
  std::size_t bright_count = 0;
  for (std::size_t n = 0; n < bright.size(); ++n) {
    bright[n] = image.voxels[n] > threshold ? 1 : 0;
    bright_count += bright[n];
  }
  const std::vector<std::size_t> near = around(image.grid, seed_in_world);
  const auto near_bright = std::count_if(near.begin(), near.end(), [&](std::size_t n) { return bright[n] == 1; });
  const bool use_bright = object == OtsuObject::shell ? 2 * bright_count <= bright.size()
                                                      : 2 * static_cast<std::size_t>(near_bright) > near.size();
  const ClassComponents parts = class_components_of(image.grid, bright, use_bright ? 1 : 0);
  Image<std::uint8_t> mask(image.grid);
  if (parts.size.empty()) return mask;
  int chosen = parts.largest();
  if (object == OtsuObject::solid) {
    std::vector<std::size_t> votes(parts.size.size(), 0);
    for (const std::size_t n : near) {
      if (parts.label[n] >= 0) ++votes[static_cast<std::size_t>(parts.label[n])];
    }
    chosen = static_cast<int>(std::max_element(votes.begin(), votes.end()) - votes.begin());
  }
  for (std::size_t n = 0; n < mask.voxels.size(); ++n) mask.voxels[n] = parts.label[n] == chosen ? 1 : 0;
  if (object == OtsuObject::shell) fill_holes(mask);
  return mask;
}

}  // namespace pellicle::bench
