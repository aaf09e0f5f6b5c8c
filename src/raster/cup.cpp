#include "pellicle/raster/cup.h"

#include <algorithm>
#include <cmath>

#include "pellicle/base/errors.h"
#include "pellicle/base/parallel.h"
#include "pellicle/mask/morphology.h"
#include "pellicle/mask/parts.h"
#include "pellicle/raster/internal/occupied_voxels.h"

namespace pellicle {

namespace {

using Mask = Image<std::uint8_t>;

/// Directions spread evenly over the sphere.
std::vector<Vec3> directions(int count) {
  std::vector<Vec3> out;
  out.reserve(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) {
    const double z = 1.0 - 2.0 * (k + 0.5) / count, r = std::sqrt(1.0 - z * z), angle = 2.399963229728653 * k;
    out.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
  }
  return out;
}

bool meets(const Mask& sheet, const Vec3& from, const Vec3& direction) {
  const Index3& size = sheet.grid.size;
  for (Vec3 at = from;; at += direction) {
    const Index3 i{static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())),
                   static_cast<int>(std::lround(at.z()))};
    for (std::size_t a = 0; a < 3; ++a) {
      if (i[a] < 0 || i[a] >= size[a]) return false;
    }
    if (sheet.at(i[0], i[1], i[2]) != 0) return true;
  }
}

// The dilated sheet and the voxels from which enough directions meet it.
void fill_below_mouth(Mask& sheet) {
  constexpr int kDirections = 128;
  constexpr double kFraction = 0.45;
  const std::vector<Vec3> looks = directions(kDirections);
  const Index3& size = sheet.grid.size;
  std::vector<std::uint8_t> inside(sheet.voxels.size());
  parallel_for(static_cast<std::size_t>(size[2]), 1, [&](std::size_t begin, std::size_t end) {
    for (auto k = static_cast<int>(begin); k < static_cast<int>(end); ++k) {
      for (int j = 0; j < size[1]; ++j) {
        for (int i = 0; i < size[0]; ++i) {
          const auto hits =
              std::count_if(looks.begin(), looks.end(), [&](const Vec3& d) { return meets(sheet, Vec3(i, j, k), d); });
          const auto at =
              (static_cast<std::size_t>(k) * static_cast<std::size_t>(size[1]) + static_cast<std::size_t>(j)) *
                  static_cast<std::size_t>(size[0]) +
              static_cast<std::size_t>(i);
          inside[at] = static_cast<double>(hits) >= kFraction * kDirections ? 1 : 0;
        }
      }
    }
  });
  for (std::size_t v = 0; v < inside.size(); ++v) sheet.voxels[v] = sheet.voxels[v] != 0 || inside[v] != 0 ? 1 : 0;
}

}  // namespace

Mask filled_cup(const std::vector<Vec3>& points, double spacing) {
  constexpr double kGrid = 32.0;
  if (points.size() < 4) throw BadData("open surface around points: at least four points are needed");
  Vec3 lo = points.front(), hi = lo;
  for (const Vec3& x : points) {
    lo = lo.cwiseMin(x);
    hi = hi.cwiseMax(x);
  }
  const double voxel = std::max((hi - lo).maxCoeff() / kGrid, 3.0 * spacing);
  Mask mask = occupied_voxels(points, lo, hi, voxel, 3);
  const auto sheet = static_cast<double>(std::count(mask.voxels.begin(), mask.voxels.end(), 1));
  grow(mask, 1);
  fill_below_mouth(mask);
  shrink(mask, 1);
  const auto filled = static_cast<double>(keep_largest_part(mask));
  if (filled < 1.5 * sheet) {
    throw BadData("open surface around points: they enclose nothing; a bowl, a cap or a tube is needed");
  }
  fill_cavities(mask);
  return mask;
}

}  // namespace pellicle
