#pragma once
/// Flooding of a mask from voxel to voxel through faces.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pellicle/image/image.h"

namespace pellicle {

/// Calls visit(offset) for each of up to six voxels that share a face with the one at offset `at`.
template <class Visit>
void for_face_neighbours(const Index3& size, std::size_t at, const Visit& visit) {
  std::size_t stride = 1;
  for (const int n : size) {
    const std::size_t along = at / stride % static_cast<std::size_t>(n);
    if (along > 0) visit(at - stride);
    if (along + 1 < static_cast<std::size_t>(n)) visit(at + stride);
    stride *= static_cast<std::size_t>(n);
  }
}

/// Voxels that are joined by faces to the one at offset `seed` and have its value get the value `mark`.
/// \pre `mark` is another value.
/// \return how many voxels.
inline std::size_t flood(Image<std::uint8_t>& mask, std::size_t seed, std::uint8_t mark) {
  const std::uint8_t from = mask.voxels[seed];
  std::vector<std::size_t> open{seed};
  mask.voxels[seed] = mark;
  std::size_t count = 0;
  while (!open.empty()) {
    const std::size_t at = open.back();
    open.pop_back();
    ++count;
    for_face_neighbours(mask.grid.size, at, [&](std::size_t next) {
      if (mask.voxels[next] != from) return;
      mask.voxels[next] = mark;
      open.push_back(next);
    });
  }
  return count;
}

}  // namespace pellicle
