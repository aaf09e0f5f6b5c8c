#include "pellicle/raster/mask_morphology.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

namespace pellicle {

namespace {

using Mask = Image<std::uint8_t>;

// Largest (grow) or smallest value within one voxel along one index axis; beyond the border counts as 0.
void pass(Mask& mask, int axis, bool grow) {
  const Index3& size = mask.grid.size;
  const auto a = static_cast<std::size_t>(axis);
  const std::size_t stride = axis == 0   ? 1
                             : axis == 1 ? static_cast<std::size_t>(size[0])
                                         : static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]);
  const auto n = static_cast<std::size_t>(size[a]);
  std::vector<std::uint8_t> line(n + 2, 0);
  for (std::size_t start = 0; start < mask.voxels.size(); ++start) {
    if ((start / stride) % n != 0) continue;
    for (std::size_t i = 0; i < n; ++i) line[i + 1] = mask.voxels[start + i * stride];
    for (std::size_t i = 0; i < n; ++i) {
      mask.voxels[start + i * stride] =
          grow ? std::max({line[i], line[i + 1], line[i + 2]}) : std::min({line[i], line[i + 1], line[i + 2]});
    }
  }
}

// visit(voxel) for each of up to six that share a face with the voxel `at`.
template <class Visit>
void for_neighbours(const Index3& size, std::size_t at, const Visit& visit) {
  std::size_t stride = 1;
  for (const int n : size) {
    const std::size_t along = at / stride % static_cast<std::size_t>(n);
    if (along > 0) visit(at - stride);
    if (along + 1 < static_cast<std::size_t>(n)) visit(at + stride);
    stride *= static_cast<std::size_t>(n);
  }
}

// Voxels that hang together by faces with `seed` and have the same value get `mark`; returns how many.
std::size_t flood(Mask& mask, std::size_t seed, std::uint8_t mark) {
  const std::uint8_t from = mask.voxels[seed];
  std::vector<std::size_t> open{seed};
  mask.voxels[seed] = mark;
  std::size_t count = 0;
  while (!open.empty()) {
    const std::size_t at = open.back();
    open.pop_back();
    ++count;
    for_neighbours(mask.grid.size, at, [&](std::size_t next) {
      if (mask.voxels[next] != from) return;
      mask.voxels[next] = mark;
      open.push_back(next);
    });
  }
  return count;
}

constexpr std::uint8_t kMain = 1, kApart = 2, kSmall = 3;

// The largest part and those of `least` voxels or more are told apart.
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
        for_neighbours(mask.grid.size, way, [&](std::size_t next) { mask.voxels[next] = kMain; });
      }
      return true;
    }
    for_neighbours(mask.grid.size, at, [&](std::size_t next) {
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

void grow_or_shrink(Mask& mask, int steps, bool grow) {
  for (int s = 0; s < steps; ++s) {
    for (int axis = 0; axis < 3; ++axis) pass(mask, axis, grow);
  }
}

void fill_cavities(Mask& mask) {
  flood(mask, 0, 2);
  for (auto& v : mask.voxels) v = v == 2 ? 0 : 1;
}

std::size_t keep_largest(Mask& mask) {
  const std::size_t most = mark_parts(mask, 0);
  for (auto& v : mask.voxels) v = v == kMain ? 1 : 0;
  return most;
}

void join_parts(Mask& mask, const Image<float>& field, std::size_t least) {
  if (mark_parts(mask, least) > 0) {
    while (join_nearest(mask, field)) {
    }
  }
  for (auto& v : mask.voxels) v = v == kMain ? 1 : 0;
}

Mask occupied_voxels(const std::vector<Vec3>& points, const Vec3& lo, const Vec3& hi, double h, int margin) {
  ImageGrid grid;
  grid.spacing = Vec3::Constant(h);
  for (int a = 0; a < 3; ++a) {
    grid.size[static_cast<std::size_t>(a)] = static_cast<int>(std::ceil((hi[a] - lo[a]) / h)) + 1 + 2 * margin;
  }
  grid.origin_in_world = lo - Vec3::Constant(margin * h);
  Mask mask(grid);
  for (const Vec3& x : points) {
    const Vec3 i = (x - grid.origin_in_world) / h;
    mask.at(static_cast<int>(std::lround(i.x())), static_cast<int>(std::lround(i.y())),
            static_cast<int>(std::lround(i.z()))) = 1;
  }
  return mask;
}

}  // namespace pellicle
