#include "pellicle/mask/parts.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <queue>
#include <utility>
#include <vector>

#include "pellicle/base/errors.h"
#include "pellicle/mask/internal/flood.h"

namespace pellicle {

namespace {

using Mask = Image<std::uint8_t>;

constexpr std::uint8_t kMain = 1, kApart = 2, kSmall = 3;

// Marks the largest part (kMain), the others of `least` voxels or more (kApart) and the rest (kSmall).
// Returns the voxels of the largest part.
std::size_t mark_parts(Mask& mask, std::size_t least) {
  std::size_t most = 0, where = 0;
  for (std::size_t i = 0; i < mask.voxels.size(); ++i) {
    if (mask.voxels[i] != kMain) continue;
    const std::size_t count = flood(mask, i, kApart);
    if (count < least) flood(mask, i, kSmall);
    if (count > most) {
      most = count;
      where = i;
    }
  }
  if (most > 0) flood(mask, where, kMain);
  return most;
}

// The cheapest way (Dijkstra) from the main part to any other: its voxels between the two, and that part, become main.
bool join_nearest(Mask& mask, const Image<float>& field) {
  constexpr float kStep = 0.01F, kFarthest = 1.5F;
  std::vector<float> cost(mask.voxels.size(), std::numeric_limits<float>::infinity());
  std::vector<std::size_t> from(mask.voxels.size());
  using Entry = std::pair<float, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  for (std::size_t i = 0; i < mask.voxels.size(); ++i) {
    if (mask.voxels[i] != kMain) continue;
    cost[i] = 0.0F;
    open.emplace(0.0F, i);
  }
  while (!open.empty()) {
    const float here = open.top().first;
    const std::size_t at = open.top().second;
    open.pop();
    if (here > cost[at]) continue;
    if (mask.voxels[at] == kApart) {
      flood(mask, at, kMain);
      std::vector<std::size_t> path;
      for (std::size_t way = from[at]; mask.voxels[way] != kMain; way = from[way]) path.push_back(way);
      for (const std::size_t way : path) {
        mask.voxels[way] = kMain;
        for_face_neighbours(mask.grid.size, way, [&](std::size_t next) { mask.voxels[next] = kMain; });
      }
      return true;
    }
    for_face_neighbours(mask.grid.size, at, [&](std::size_t next) {
      const float there = here + kStep + std::clamp(0.5F - field.voxels[next], 0.0F, 0.5F);
      if (there > kFarthest || there >= cost[next]) return;
      cost[next] = there;
      from[next] = at;
      open.emplace(there, next);
    });
  }
  return false;
}

}  // namespace

std::size_t keep_largest_part(Mask& mask) {
  for (auto& v : mask.voxels) v = v != 0 ? kMain : 0;
  const std::size_t most = mark_parts(mask, 0);
  for (auto& v : mask.voxels) v = v == kMain ? 1 : 0;
  return most;
}

Mask cropped(const Mask& mask, int margin) {
  Index3 lo = mask.grid.size, hi{-1, -1, -1};
  const auto for_each_inside = [&](const auto& body) {
    std::size_t voxel = 0;
    for (int k = 0; k < mask.grid.size[2]; ++k) {
      for (int j = 0; j < mask.grid.size[1]; ++j) {
        for (int i = 0; i < mask.grid.size[0]; ++i, ++voxel) {
          if (mask.voxels[voxel] != 0) body(Index3{i, j, k});
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
  if (hi[0] < 0) return {};
  ImageGrid grid = mask.grid;
  for (std::size_t a = 0; a < 3; ++a) grid.size[a] = hi[a] - lo[a] + 1 + 2 * margin;
  grid.origin_in_world = mask.grid.world_from_index(Vec3(lo[0] - margin, lo[1] - margin, lo[2] - margin));
  Mask part(grid);
  for_each_inside(
      [&](const Index3& at) { part.at(at[0] - lo[0] + margin, at[1] - lo[1] + margin, at[2] - lo[2] + margin) = 1; });
  return part;
}

Mask largest_part(const Mask& mask, int margin) {
  Mask whole = mask;
  if (keep_largest_part(whole) == 0) throw BadData("the mask is empty");
  return cropped(whole, margin);
}

void join_parts(Mask& mask, const Image<float>& field, std::size_t least) {
  if (mark_parts(mask, least) > 0) {
    while (join_nearest(mask, field)) {
    }
  }
  for (auto& v : mask.voxels) v = v == kMain ? 1 : 0;
}

}  // namespace pellicle
