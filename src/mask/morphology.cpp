#include "pellicle/mask/morphology.h"

#include <algorithm>
#include <vector>

#include "pellicle/mask/internal/flood.h"

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

}  // namespace

void grow(Mask& mask, int steps) {
  for (int s = 0; s < steps; ++s) {
    for (int axis = 0; axis < 3; ++axis) pass(mask, axis, true);
  }
}

void shrink(Mask& mask, int steps) {
  for (int s = 0; s < steps; ++s) {
    for (int axis = 0; axis < 3; ++axis) pass(mask, axis, false);
  }
}

Mask shrunk_by_faces(const Mask& mask) {
  Mask result(mask.grid);
  for (std::size_t at = 0; at < mask.voxels.size(); ++at) {
    int inside = mask.voxels[at] != 0 ? 1 : 0;
    for_face_neighbours(mask.grid.size, at, [&](std::size_t next) { inside += mask.voxels[next] != 0 ? 1 : 0; });
    result.voxels[at] = inside == 7 ? 1 : 0;
  }
  return result;
}

std::size_t fill_cavities(Mask& mask) {
  constexpr std::uint8_t kOutside = 2;
  flood(mask, 0, kOutside);
  std::size_t filled = 0;
  for (auto& v : mask.voxels) {
    filled += v == 0 ? 1 : 0;
    v = v == kOutside ? 0 : 1;
  }
  return filled;
}

}  // namespace pellicle
