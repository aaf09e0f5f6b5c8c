#pragma once
/// A volume in memory: a grid and its voxels, x fastest. A plain value.

#include <vector>

#include "pellicle/image/image_grid.h"

namespace pellicle {

template <class T>
struct Image {
  ImageGrid grid;
  std::vector<T> voxels;  ///< grid.voxel_count() values, x fastest

  Image() = default;
  explicit Image(const ImageGrid& g, T value = T{}) : grid(g), voxels(g.voxel_count(), value) {}
  T& at(int i, int j, int k) { return voxels[grid.offset(i, j, k)]; }
  const T& at(int i, int j, int k) const { return voxels[grid.offset(i, j, k)]; }
};

}  // namespace pellicle
