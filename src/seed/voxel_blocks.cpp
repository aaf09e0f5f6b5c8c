// The boundary of voxels made a manifold, and its faces.
#include <algorithm>
#include <array>
#include <unordered_map>

#include "pellicle/base/errors.h"
#include "pellicle/mask/morphology.h"
#include "pellicle/mask/parts.h"
#include "pellicle/seed/voxel_seed.h"

namespace pellicle {
namespace {

constexpr std::array<Index3, 6> kFaces{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};

bool at_or_empty(const Image<std::uint8_t>& voxels, int i, int j, int k) {
  const Index3& n = voxels.grid.size;
  return i >= 0 && j >= 0 && k >= 0 && i < n[0] && j < n[1] && k < n[2] && voxels.at(i, j, k) != 0;
}

template <class Visit>
void for_each_voxel(const Index3& size, const Visit& visit) {
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i) visit(i, j, k);
    }
  }
}

unsigned pattern_at(const Image<std::uint8_t>& voxels, int i, int j, int k) {
  unsigned pattern = 0;
  for (int c = 0; c < 8; ++c) {
    if (at_or_empty(voxels, i + (c >> 2), j + (c >> 1 & 1), k + (c & 1))) pattern |= 1U << c;
  }
  return pattern;
}

void fill_one(Image<std::uint8_t>& voxels, int i, int j, int k) {
  int most = -1;
  Index3 chosen{i, j, k};
  for (int c = 0; c < 8; ++c) {
    const Index3 v{i + (c >> 2), j + (c >> 1 & 1), k + (c & 1)};
    if (voxels.at(v[0], v[1], v[2]) != 0) continue;
    int neighbours = 0;
    for (const Index3& d : kFaces) neighbours += at_or_empty(voxels, v[0] + d[0], v[1] + d[1], v[2] + d[2]) ? 1 : 0;
    if (neighbours <= most) continue;
    most = neighbours;
    chosen = v;
  }
  voxels.at(chosen[0], chosen[1], chosen[2]) = 1;
}

/// One pass over all blocks; returns how many voxels were filled.
std::size_t repair_pass(Image<std::uint8_t>& voxels, const std::array<bool, 256>& critical) {
  std::size_t filled = 0;
  const Index3& n = voxels.grid.size;
  for_each_voxel({n[0] - 1, n[1] - 1, n[2] - 1}, [&](int i, int j, int k) {
    while (critical[pattern_at(voxels, i, j, k)]) {
      fill_one(voxels, i, j, k);
      ++filled;
    }
  });
  return filled;
}

}  // namespace

VoxelBlock classify_block(unsigned pattern) {
  const auto inside = [&](int a, int b, int c) { return (pattern >> (4 * a + 2 * b + c) & 1U) != 0; };
  // Half-axes 2 axis + side; a face between two voxels lies between two of them.
  std::vector<std::array<int, 2>> faces;
  for (int axis = 0; axis < 3; ++axis) {
    for (int s = 0; s < 4; ++s) {
      std::array<int, 3> v{};
      const int first = axis == 0 ? 1 : 0, second = axis == 2 ? 1 : 2;
      v[static_cast<std::size_t>(first)] = s >> 1;
      v[static_cast<std::size_t>(second)] = s & 1;
      std::array<int, 3> w = v;
      w[static_cast<std::size_t>(axis)] = 1;
      if (inside(v[0], v[1], v[2]) == inside(w[0], w[1], w[2])) continue;
      faces.push_back({2 * first + (s >> 1), 2 * second + (s & 1)});
    }
  }
  if (faces.empty()) return {};
  const int valence = static_cast<int>(faces.size());
  std::array<int, 6> degree{}, part{};
  for (int h = 0; h < 6; ++h) part[static_cast<std::size_t>(h)] = h;
  for (std::size_t round = 0; round < faces.size(); ++round) {
    for (const auto& [a, b] : faces) {
      int &p = part[static_cast<std::size_t>(a)], &q = part[static_cast<std::size_t>(b)];
      p = q = std::min(p, q);
      if (round > 0) continue;
      ++degree[static_cast<std::size_t>(a)];
      ++degree[static_cast<std::size_t>(b)];
    }
  }
  int only = -1;
  bool one_fan = true;
  for (std::size_t h = 0; h < 6; ++h) {
    if (degree[h] == 0) continue;
    if (degree[h] != 2) return {VoxelBlock::Kind::edge_fault, valence};
    one_fan = one_fan && (only < 0 || part[h] == only);
    only = part[h];
  }
  return {one_fan ? VoxelBlock::Kind::manifold : VoxelBlock::Kind::vertex_fault, valence};
}

std::size_t make_manifold(Image<std::uint8_t>& voxels) {
  std::array<bool, 256> critical{};
  for (unsigned p = 0; p < 256; ++p) {
    const VoxelBlock::Kind kind = classify_block(p).kind;
    critical[p] = kind == VoxelBlock::Kind::edge_fault || kind == VoxelBlock::Kind::vertex_fault;
  }
  voxels = cropped(voxels, 1);
  if (voxels.voxels.empty()) throw BadData("voxel seed (all): no voxel is inside");
  keep_largest_part(voxels);
  std::size_t filled = 0;
  for (std::size_t now = 1; now > 0; filled += now) {  // a repaired neck may close a cavity off
    now = fill_cavities(voxels);
    for (std::size_t pass = 1; pass > 0; now += pass) pass = repair_pass(voxels, critical);
  }
  voxels = cropped(voxels, 1);
  return filled;
}

QuadMesh boundary_of_voxels(const Image<std::uint8_t>& voxels) {
  // The face towards each of kFaces, counter-clockwise seen from outside, as offsets of grid vertices.
  constexpr std::array<std::array<Index3, 4>, 6> kCorners{{{{{1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {1, 0, 1}}},
                                                           {{{0, 0, 0}, {0, 0, 1}, {0, 1, 1}, {0, 1, 0}}},
                                                           {{{0, 1, 0}, {0, 1, 1}, {1, 1, 1}, {1, 1, 0}}},
                                                           {{{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}}},
                                                           {{{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}},
                                                           {{{0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0}}}}};
  ImageGrid corners = voxels.grid;
  for (int& n : corners.size) ++n;
  const bool mirrored = voxels.grid.direction.determinant() < 0;
  std::unordered_map<std::size_t, int> number;
  QuadMesh mesh;
  for_each_voxel(voxels.grid.size, [&](int i, int j, int k) {
    if (voxels.at(i, j, k) == 0) return;
    for (std::size_t face = 0; face < 6; ++face) {
      const Index3& d = kFaces[face];
      if (at_or_empty(voxels, i + d[0], j + d[1], k + d[2])) continue;
      Quad quad{};
      for (std::size_t c = 0; c < 4; ++c) {
        const Index3& o = kCorners[face][c];
        const Index3 at{i + o[0], j + o[1], k + o[2]};
        const auto [entry, fresh] =
            number.try_emplace(corners.offset(at[0], at[1], at[2]), static_cast<int>(mesh.vertices.size()));
        if (fresh) mesh.vertices.push_back(voxels.grid.world_from_index(Vec3(at[0] - 0.5, at[1] - 0.5, at[2] - 0.5)));
        quad[c] = entry->second;
      }
      if (mirrored) std::swap(quad[1], quad[3]);
      mesh.quads.push_back(quad);
    }
  });
  if (mesh.quads.empty()) throw BadData("voxel seed (all): no voxel is inside");
  quad_topology(static_cast<int>(mesh.vertices.size()), mesh.quads);
  return mesh;
}

}  // namespace pellicle
