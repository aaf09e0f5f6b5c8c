#include "pellicle/image/reorder.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace pellicle {

namespace {

// For each world axis the index axis that runs along it: the permutation with the largest sum of cosines.
Index3 axes_along_world(const Mat3& direction) {
  Index3 order{0, 1, 2}, best = order;
  double best_sum = -1.0;
  do {
    double sum = 0.0;
    for (std::size_t w = 0; w < 3; ++w) sum += std::abs(direction(static_cast<int>(w), order[w]));
    if (sum > best_sum + 1e-9) {
      best_sum = sum;
      best = order;
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

template <class T>
void reverse_axis(Image<T>& image, std::size_t axis) {
  const Index3& size = image.grid.size;
  const int half = size[axis] / 2;
  Index3 end = size;
  end[axis] = half;
  for (int k = 0; k < end[2]; ++k) {
    for (int j = 0; j < end[1]; ++j) {
      for (int i = 0; i < end[0]; ++i) {
        Index3 other{i, j, k};
        other[axis] = size[axis] - 1 - other[axis];
        std::swap(image.at(i, j, k), image.at(other[0], other[1], other[2]));
      }
    }
  }
}

}  // namespace

template <class T>
Image<T> in_lps_order(Image<T> image) {
  const ImageGrid from = image.grid;
  const Index3 axes = axes_along_world(from.direction);
  ImageGrid grid = from;
  Vec3 first_in_index = Vec3::Zero();
  std::array<bool, 3> reversed{};
  for (std::size_t w = 0; w < 3; ++w) {
    const int a = axes[w], column = static_cast<int>(w);
    grid.size[w] = from.size[static_cast<std::size_t>(a)];
    grid.spacing[column] = from.spacing[a];
    reversed[w] = from.direction(column, a) < 0.0;
    grid.direction.col(column) = (reversed[w] ? -1.0 : 1.0) * from.direction.col(a);
    if (reversed[w]) first_in_index[a] = from.size[static_cast<std::size_t>(a)] - 1;
  }
  // A zero stays a positive zero, so that grids that are equal have equal bytes.
  grid.direction = grid.direction.array() + 0.0;
  grid.origin_in_world = from.world_from_index(first_in_index).array() + 0.0;
  if (axes != Index3{0, 1, 2}) {
    Image<T> out;
    out.grid = grid;
    out.voxels.resize(image.voxels.size());
    const std::array<std::size_t, 3> step{
        1, static_cast<std::size_t>(from.size[0]),
        static_cast<std::size_t>(from.size[0]) * static_cast<std::size_t>(from.size[1])};
    std::size_t at = 0;
    for (int k = 0; k < grid.size[2]; ++k) {
      for (int j = 0; j < grid.size[1]; ++j) {
        const std::size_t row = static_cast<std::size_t>(j) * step[static_cast<std::size_t>(axes[1])] +
                                static_cast<std::size_t>(k) * step[static_cast<std::size_t>(axes[2])];
        const std::size_t along = step[static_cast<std::size_t>(axes[0])];
        for (std::size_t i = 0; i < static_cast<std::size_t>(grid.size[0]); ++i)
          out.voxels[at++] = image.voxels[row + i * along];
      }
    }
    image = std::move(out);
  }
  image.grid = grid;
  for (std::size_t w = 0; w < 3; ++w) {
    if (reversed[w]) reverse_axis(image, w);
  }
  return image;
}

template Image<float> in_lps_order(Image<float>);
template Image<std::uint8_t> in_lps_order(Image<std::uint8_t>);

}  // namespace pellicle
