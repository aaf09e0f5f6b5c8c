#include "pellicle/seed/territories.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pellicle {

namespace {

constexpr int kLevels = 65536;

/// A queue: the highest level comes first, within a level first in, first out.
class LevelQueue {
 public:
  explicit LevelQueue(std::size_t voxels) : next_(voxels, -1), head_(kLevels, -1), tail_(kLevels, -1) {}
  void push(std::int32_t voxel, int level) {
    const auto l = static_cast<std::size_t>(level);
    if (head_[l] < 0) {
      head_[l] = voxel;
    } else {
      next_[static_cast<std::size_t>(tail_[l])] = voxel;
    }
    tail_[l] = voxel;
    top_ = std::max(top_, level);
  }
  /// -1 when empty.
  std::int32_t pop() {
    while (top_ >= 0 && head_[static_cast<std::size_t>(top_)] < 0) --top_;
    if (top_ < 0) return -1;
    std::int32_t& head = head_[static_cast<std::size_t>(top_)];
    const std::int32_t voxel = head;
    head = next_[static_cast<std::size_t>(voxel)];
    return voxel;
  }

 private:
  std::vector<std::int32_t> next_, head_, tail_;
  int top_ = -1;
};

}  // namespace

Image<std::int32_t> territories_of(const Image<float>& response, const std::vector<Vec3>& seeds) {
  const ImageGrid& grid = response.grid;
  Image<std::int32_t> owner(grid);
  if (response.voxels.empty()) return owner;
  const auto [low, high] = std::minmax_element(response.voxels.begin(), response.voxels.end());
  const float from = *low, scale = *high > *low ? static_cast<float>(kLevels - 1) / (*high - *low) : 0.0F;
  const auto level = [&](std::size_t i) { return static_cast<int>((response.voxels[i] - from) * scale); };
  LevelQueue queue(owner.voxels.size());
  for (std::size_t s = 0; s < seeds.size(); ++s) {
    const Vec3 index = grid.index_from_world(seeds[s]);
    Index3 at{};
    for (int a = 0; a < 3; ++a) {
      const auto axis = static_cast<std::size_t>(a);
      at[axis] = std::clamp(static_cast<int>(std::lround(index[a])), 0, grid.size[axis] - 1);
    }
    const std::size_t voxel = grid.offset(at[0], at[1], at[2]);
    if (owner.voxels[voxel] != 0) continue;
    owner.voxels[voxel] = static_cast<std::int32_t>(s) + 1;
    queue.push(static_cast<std::int32_t>(voxel), level(voxel));
  }
  const int nx = grid.size[0], ny = grid.size[1], nz = grid.size[2];
  for (std::int32_t voxel = queue.pop(); voxel >= 0; voxel = queue.pop()) {
    const auto from_voxel = static_cast<std::size_t>(voxel);
    const int i = voxel % nx, j = voxel / nx % ny, k = voxel / nx / ny;
    const std::int32_t own = owner.voxels[from_voxel];
    const auto reach = [&](bool inside, std::ptrdiff_t offset) {
      if (!inside) return;
      const auto to = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(from_voxel) + offset);
      if (owner.voxels[to] != 0) return;
      owner.voxels[to] = own;
      queue.push(static_cast<std::int32_t>(to), level(to));
    };
    const std::ptrdiff_t slice = static_cast<std::ptrdiff_t>(nx) * ny;
    reach(i > 0, -1);
    reach(i + 1 < nx, 1);
    reach(j > 0, -nx);
    reach(j + 1 < ny, nx);
    reach(k > 0, -slice);
    reach(k + 1 < nz, slice);
  }
  return owner;
}

}  // namespace pellicle
