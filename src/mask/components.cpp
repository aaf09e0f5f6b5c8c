#include "pellicle/mask/components.h"

#include <algorithm>
#include <array>

namespace pellicle {

namespace {

constexpr std::array<Index3, 6> kNeighbours{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};

bool inside_grid(const ImageGrid& grid, const Index3& v) {
  for (std::size_t a = 0; a < 3; ++a) {
    if (v[a] < 0 || v[a] >= grid.size[a]) return false;
  }
  return true;
}

// Layers from the border inward: the last layer of a part holds its deepest voxels.
void find_deepest(const Image<std::int32_t>& labels, std::vector<Component>& parts) {
  std::vector<Index3> layer;
  Image<std::int32_t> depth(labels.grid, 0);
  const Index3& size = labels.grid.size;
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i) {
        if (labels.at(i, j, k) == 0) continue;
        for (const Index3& d : kNeighbours) {
          const Index3 n{i + d[0], j + d[1], k + d[2]};
          if (!inside_grid(labels.grid, n) || labels.at(n[0], n[1], n[2]) != labels.at(i, j, k)) {
            depth.at(i, j, k) = 1;
            layer.push_back({i, j, k});
            break;
          }
        }
      }
    }
  }
  std::vector<int> deepest(parts.size(), 0);
  while (!layer.empty()) {
    std::vector<Index3> next;
    for (const Index3& v : layer) {
      const int d = depth.at(v[0], v[1], v[2]);
      const auto id = static_cast<std::size_t>(labels.at(v[0], v[1], v[2]) - 1);
      if (d > deepest[id]) {
        deepest[id] = d;
        parts[id].deepest = labels.grid.world_from_index(Vec3(v[0], v[1], v[2]));
        parts[id].depth = (d - 0.5) * labels.grid.mean_spacing();
      }
      for (const Index3& step : kNeighbours) {
        const Index3 n{v[0] + step[0], v[1] + step[1], v[2] + step[2]};
        if (!inside_grid(labels.grid, n) || labels.at(n[0], n[1], n[2]) == 0 || depth.at(n[0], n[1], n[2]) != 0)
          continue;
        depth.at(n[0], n[1], n[2]) = d + 1;
        next.push_back(n);
      }
    }
    layer.swap(next);
  }
}

}  // namespace

Components components_of(const Image<std::uint8_t>& mask) {
  Components out{Image<std::int32_t>(mask.grid, 0), {}};
  const Index3& size = mask.grid.size;
  std::vector<Index3> stack;
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i) {
        if (mask.at(i, j, k) == 0 || out.labels.at(i, j, k) != 0) continue;
        Component part;
        part.id = static_cast<int>(out.parts.size()) + 1;
        stack.push_back({i, j, k});
        out.labels.at(i, j, k) = part.id;
        while (!stack.empty()) {
          const Index3 v = stack.back();
          stack.pop_back();
          ++part.voxels;
          for (const Index3& d : kNeighbours) {
            const Index3 n{v[0] + d[0], v[1] + d[1], v[2] + d[2]};
            if (!inside_grid(mask.grid, n) || mask.at(n[0], n[1], n[2]) == 0 || out.labels.at(n[0], n[1], n[2]) != 0)
              continue;
            out.labels.at(n[0], n[1], n[2]) = part.id;
            stack.push_back(n);
          }
        }
        out.parts.push_back(part);
      }
    }
  }
  std::stable_sort(out.parts.begin(), out.parts.end(),
                   [](const Component& a, const Component& b) { return a.voxels > b.voxels; });
  std::vector<std::int32_t> rank(out.parts.size() + 1, 0);
  for (std::size_t r = 0; r < out.parts.size(); ++r) {
    rank[static_cast<std::size_t>(out.parts[r].id)] = static_cast<std::int32_t>(r) + 1;
    out.parts[r].id = static_cast<int>(r) + 1;
  }
  for (std::int32_t& label : out.labels.voxels) label = rank[static_cast<std::size_t>(label)];
  find_deepest(out.labels, out.parts);
  return out;
}

}  // namespace pellicle
