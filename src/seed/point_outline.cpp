#include "pellicle/seed/point_outline.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "pellicle/base/errors.h"
#include "pellicle/base/parallel.h"
#include "pellicle/mask/components.h"
#include "pellicle/mask/parts.h"
#include "pellicle/mesh/points/point_tree.h"

namespace pellicle {

namespace {

constexpr double kRadii[] = {1.0, 1.25, 1.6, 2.0};  // in gaps
// Of points strewn at random over a surface the nearest other one is in the median 0.47 of the mean gap away.
constexpr double kGapOverSpacing = 2.1;
constexpr double kMostAlongAnEdge = 80.0;  // along the longest edge

Image<float> grid_around(const std::vector<Vec3>& points, double spacing, double margin) {
  Vec3 low = points.front(), high = low;
  for (const Vec3& x : points) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  ImageGrid grid;
  grid.spacing = Vec3::Constant(spacing);
  grid.origin_in_world = low - Vec3::Constant(margin);
  for (int a = 0; a < 3; ++a) {
    grid.size[static_cast<std::size_t>(a)] =
        static_cast<int>(std::ceil((high[a] - low[a] + 2.0 * margin) / spacing)) + 1;
  }
  return Image<float>(grid);
}

Vec3 place_of(const ImageGrid& grid, std::size_t i) {
  const auto nx = static_cast<std::size_t>(grid.size[0]), ny = static_cast<std::size_t>(grid.size[1]);
  const std::size_t row = i / nx;
  const std::array<std::size_t, 3> index{i % nx, row % ny, row / ny};
  return grid.world_from_index(
      Vec3(static_cast<double>(index[0]), static_cast<double>(index[1]), static_cast<double>(index[2])));
}

// Distance of every voxel's centre that is asked about to the nearest of the tree's points.
void distances(const PointTree& tree, const std::vector<std::uint8_t>& asked, Image<float>& out) {
  parallel_for(out.voxels.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (asked[i] != 0) out.voxels[i] = static_cast<float>(tree.nearest(place_of(out.grid, i), 1).front().distance);
    }
  });
}

// Voxels that are connected to the first corner (which is outside) without coming as near to a point as `radius`.
std::vector<std::uint8_t> outside_of(const Image<float>& distance, double radius) {
  Image<std::uint8_t> open(distance.grid);
  for (std::size_t i = 0; i < open.voxels.size(); ++i)
    open.voxels[i] = static_cast<double>(distance.voxels[i]) > radius ? 1 : 0;
  const Components parts = components_of(open);
  const std::int32_t corner = parts.labels.voxels.front();
  std::vector<std::uint8_t> outside(open.voxels.size());
  for (std::size_t i = 0; i < outside.size(); ++i) outside[i] = parts.labels.voxels[i] == corner && corner != 0 ? 1 : 0;
  return outside;
}

std::vector<Vec3> border_of(const ImageGrid& grid, const std::vector<std::uint8_t>& outside) {
  const auto nx = static_cast<std::ptrdiff_t>(grid.size[0]), ny = static_cast<std::ptrdiff_t>(grid.size[1]);
  const std::ptrdiff_t steps[] = {1, -1, nx, -nx, nx * ny, -nx * ny};
  std::vector<Vec3> border;
  const auto size = static_cast<std::ptrdiff_t>(outside.size());
  for (std::ptrdiff_t i = 0; i < size; ++i) {
    if (outside[static_cast<std::size_t>(i)] == 0) continue;
    const bool at_border = std::any_of(std::begin(steps), std::end(steps), [&](std::ptrdiff_t step) {
      return i + step >= 0 && i + step < size && outside[static_cast<std::size_t>(i + step)] == 0;
    });
    if (at_border) border.push_back(place_of(grid, static_cast<std::size_t>(i)));
  }
  return border;
}

}  // namespace

Image<std::uint8_t> mask_of_points(const std::vector<Vec3>& points) {
  if (points.size() < 4) throw BadData("points (outline): fewer than four enclose nothing; give more");
  const PointTree tree(points);
  Vec3 low = points.front(), high = low;
  for (const Vec3& x : points) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  const double extent = (high - low).maxCoeff();
  const double gap = std::max(kGapOverSpacing * point_spacing(tree), 3.0 * extent / kMostAlongAnEdge);
  if (!(gap > 0.0)) throw BadData("points (outline): all in one place; give points around the object");
  const double spacing = gap / 3.0;
  Image<float> distance = grid_around(points, spacing, (kRadii[3] + 1.0) * gap);
  distances(tree, std::vector<std::uint8_t>(distance.voxels.size(), 1), distance);
  std::vector<Image<std::uint8_t>> solids;
  std::vector<double> volumes;
  for (const double factor : kRadii) {
    const double radius = factor * gap;
    const std::vector<std::uint8_t> outside = outside_of(distance, radius);
    std::vector<std::uint8_t> asked(outside.size());
    for (std::size_t i = 0; i < asked.size(); ++i) asked[i] = outside[i] == 0 ? 1 : 0;
    Image<float> depth(distance.grid);
    distances(PointTree(border_of(distance.grid, outside)), asked, depth);
    Image<std::uint8_t> solid(distance.grid);
    double voxels = 0.0;
    for (std::size_t i = 0; i < asked.size(); ++i) {
      // The border's centres lie half a voxel outside on average.
      solid.voxels[i] = asked[i] != 0 && static_cast<double>(depth.voxels[i]) > radius + 0.5 * spacing ? 1 : 0;
      voxels += solid.voxels[i];
    }
    solids.push_back(std::move(solid));
    volumes.push_back(voxels);
  }
  const double most = *std::max_element(volumes.begin(), volumes.end());
  if (!(most > 0.0)) throw BadData("points (outline): they enclose no volume; give points all around the object");
  const auto at = std::find_if(volumes.begin(), volumes.end(), [&](double v) { return v >= 0.6 * most; });
  Image<std::uint8_t>& mask = solids[static_cast<std::size_t>(at - volumes.begin())];
  keep_largest_part(mask);
  return mask;
}

}  // namespace pellicle
