#include "pellicle/mask/limb_growth.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <queue>
#include <utility>

namespace pellicle {

namespace {

constexpr int kMiddle = 13;

struct Offset {
  int x, y, z;
  int steps() const { return std::abs(x) + std::abs(y) + std::abs(z); }
};

Offset offset_of(int bit) {
  return {bit % 3 - 1, bit / 3 % 3 - 1, bit / 9 - 1};
}

using Neighbours = std::array<std::uint32_t, 27>;  ///< of each cell of the block

/// Cells that share a corner and are `reach` steps apart or less: 1 by faces, 3 by corners.
Neighbours neighbours_within(int reach) {
  Neighbours out{};
  for (int a = 0; a < 27; ++a) {
    for (int b = 0; b < 27; ++b) {
      const Offset p = offset_of(a), q = offset_of(b), d{q.x - p.x, q.y - p.y, q.z - p.z};
      const bool touch = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) <= 1;
      if (touch && d.steps() <= reach) out[static_cast<std::size_t>(a)] |= 1U << b;
    }
  }
  return out;
}

/// Parts of `cells` that hold one of `seeds`.
int parts_of(std::uint32_t cells, std::uint32_t seeds, const Neighbours& neighbours) {
  int parts = 0;
  for (std::uint32_t left = cells & seeds; left != 0; ++parts) {
    std::uint32_t part = 0;
    for (std::uint32_t open = left & (~left + 1U); open != 0; open &= ~part) {
      const int cell = std::countr_zero(open);
      part |= 1U << cell;
      open |= neighbours[static_cast<std::size_t>(cell)] & cells;
    }
    left &= ~part;
  }
  return parts;
}

std::uint32_t cells_within(int steps) {
  std::uint32_t cells = 0;
  for (int bit = 0; bit < 27; ++bit) {
    if (bit != kMiddle && offset_of(bit).steps() <= steps) cells |= 1U << bit;
  }
  return cells;
}

int bit_at(int x, int y, int z) {
  return kMiddle + x + 3 * y + 9 * z;
}

/// Whether the faces around the middle, turned on, are a surface at each of its edges and corners: no two voxels that
/// meet there alone, no two empty ones.
bool meets_by_faces(std::uint32_t inside) {
  const auto in = [&](int x, int y, int z) { return (inside >> bit_at(x, y, z) & 1U) != 0; };
  for (int corner = 0; corner < 8; ++corner) {
    const int x = 2 * (corner & 1) - 1, y = 2 * (corner >> 1 & 1) - 1, z = 2 * (corner >> 2 & 1) - 1;
    const std::array<bool, 3> face{in(x, 0, 0), in(0, y, 0), in(0, 0, z)};
    const std::array<bool, 3> edge{in(0, y, z), in(x, 0, z), in(x, y, 0)};  // across from that face
    int count = in(x, y, z) ? 1 : 0;
    bool opposite = false;
    for (std::size_t a = 0; a < 3; ++a) {
      if (edge[a] && !face[(a + 1) % 3] && !face[(a + 2) % 3]) return false;
      count += (face[a] ? 1 : 0) + (edge[a] ? 1 : 0);
      opposite = opposite || (!face[a] && !edge[a]);
    }
    if (in(x, y, z) && count == 1) return false;
    if (count == 5 && opposite) return false;
  }
  return true;
}

/// The seven voxels around that an octant touches.
std::array<std::uint32_t, 8> neighbours_of_octants() {
  std::array<std::uint32_t, 8> touching{};
  for (int octant = 0; octant < 8; ++octant) {
    for (int step = 1; step < 8; ++step) {
      int bit = kMiddle;
      for (int a = 0, stride = 1; a < 3; ++a, stride *= 3) {
        if ((step >> a & 1) != 0) bit += (octant >> a & 1) != 0 ? stride : -stride;
      }
      touching[static_cast<std::size_t>(octant)] |= 1U << bit;
    }
  }
  return touching;
}

}  // namespace

bool is_simple(std::uint32_t inside) {
  static const std::uint32_t faces = cells_within(1), edges = cells_within(2), all = cells_within(3);
  static const Neighbours by_faces = neighbours_within(1), by_corners = neighbours_within(3);
  return parts_of(inside & edges, faces, by_faces) == 1 && parts_of(~inside & all, all, by_corners) == 1;
}

void grow_along_limbs(Image<std::uint8_t>& mask, const Image<std::uint8_t>& octants) {
  static const std::array<std::uint32_t, 8> touching = neighbours_of_octants();
  static const std::uint32_t faces = cells_within(1);
  const Index3& n = mask.grid.size;
  const auto for_around = [&](const Index3& at, const auto& visit) {  // visit(bit, voxel)
    for (int bit = 0; bit < 27; ++bit) {
      const Offset d = offset_of(bit);
      const Index3 next{at[0] + d.x, at[1] + d.y, at[2] + d.z};
      bool within = true;
      for (std::size_t a = 0; a < 3; ++a) within = within && next[a] >= 0 && next[a] < n[a];
      if (within) visit(bit, next);
    }
  };
  const auto held = [&](const Index3& v) { return octants.at(v[0], v[1], v[2]); };
  const auto around = [&](const Index3& at) {
    std::uint32_t inside = 0;
    for_around(at, [&](int bit, const Index3& v) { inside |= mask.at(v[0], v[1], v[2]) != 0 ? 1U << bit : 0U; });
    return inside;
  };
  const auto is_missed = [&](const Index3& v, std::uint32_t inside) {
    for (std::size_t octant = 0; octant < 8; ++octant) {
      if ((held(v) >> octant & 1U) != 0 && (inside & touching[octant]) == 0) return true;
    }
    return false;
  };
  const auto leads_on = [&](const Index3& at) {  // to a voxel that is missed and shares no face with the mask yet
    bool leads = false;
    for_around(at, [&](int, const Index3& v) {
      if (leads || held(v) == 0) return;
      const std::uint32_t inside = around(v);
      leads = (inside & faces) == 0 && (inside >> kMiddle & 1U) == 0 && is_missed(v, inside);
    });
    return leads;
  };
  std::priority_queue<std::pair<int, Index3>> open;
  const auto offer = [&](const Index3& at) {
    if (mask.at(at[0], at[1], at[2]) == 0) open.emplace(std::popcount(held(at)), at);
  };
  for (int k = 0; k < n[2]; ++k) {
    for (int j = 0; j < n[1]; ++j) {
      for (int i = 0; i < n[0]; ++i) {
        if (around({i, j, k}) != 0) offer({i, j, k});
      }
    }
  }
  while (!open.empty()) {
    const Index3 at = open.top().second;
    open.pop();
    const std::uint32_t inside = around(at);
    if ((inside >> kMiddle & 1U) != 0 || !is_simple(inside) || !meets_by_faces(inside) ||
        !(is_missed(at, inside) || leads_on(at)))
      continue;
    mask.at(at[0], at[1], at[2]) = 1;
    for_around(at, [&](int, const Index3& v) { offer(v); });
  }
}

}  // namespace pellicle
