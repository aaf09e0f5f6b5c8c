#include "pellicle/raster/mask_morphology.h"

#include <algorithm>
#include <cmath>

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

// Voxels that hang together by faces with `seed` and have the same value get `mark`; returns how many.
std::size_t flood(Mask& mask, std::size_t seed, std::uint8_t mark) {
  const Index3& size = mask.grid.size;
  const std::size_t nx = static_cast<std::size_t>(size[0]), ny = static_cast<std::size_t>(size[1]),
                    nz = static_cast<std::size_t>(size[2]);
  const std::uint8_t from = mask.voxels[seed];
  std::vector<std::size_t> open{seed};
  mask.voxels[seed] = mark;
  std::size_t count = 0;
  const auto visit = [&](bool there, std::size_t at) {
    if (!there || mask.voxels[at] != from) return;
    mask.voxels[at] = mark;
    open.push_back(at);
  };
  while (!open.empty()) {
    const std::size_t at = open.back();
    open.pop_back();
    ++count;
    const std::size_t x = at % nx, y = at / nx % ny, z = at / (nx * ny);
    visit(x > 0, at - 1);
    visit(x + 1 < nx, at + 1);
    visit(y > 0, at - nx);
    visit(y + 1 < ny, at + nx);
    visit(z > 0, at - nx * ny);
    visit(z + 1 < nz, at + nx * ny);
  }
  return count;
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
  std::size_t most = 0, where = 0;
  for (std::size_t i = 0; i < mask.voxels.size(); ++i) {
    if (mask.voxels[i] != 1) continue;
    const std::size_t count = flood(mask, i, 2);
    if (count > most) {
      most = count;
      where = i;
    }
  }
  if (most > 0) flood(mask, where, 1);
  for (auto& v : mask.voxels) v = v == 1 ? 1 : 0;
  return most;
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
