// OpenVDB's level set, checked voxel by voxel against winding numbers along the rows of the grid. These are exact to
// rounding; OpenVDB's signs are not: of a sphere, a torus and a blob in 64^3 voxels 13 to 23 voxels were wrong, all
// within 0.04 voxels of the surface.
#include <algorithm>
#include <cmath>
#include <utility>

#include "pellicle/base/parallel.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/raster/internal/index_mesh.h"
#include "pellicle/raster/internal/level_set.h"
#include "pellicle/raster/rasterize.h"

namespace pellicle {

namespace {

// By how much the volumes may differ: the layer of 0.02 voxels about the surface in which OpenVDB's signs are unsure,
// or half a per cent where that is more (coarse facets, whose edges mislead it).
constexpr double kLayer = 0.02, kVolumeFraction = 0.005;

struct Crossing {
  int row;     ///< j
  int column;  ///< first voxel whose centre the crossing lies before or on
  int change;  ///< of the winding number there: +1 into the solid
};

struct Cut {
  double y, x;
};

// Where the edge meets the plane z = k. Always computed from the lower vertex number, so that both facets at the edge
// get the same bits: the cuts of a slice form closed loops, and every row crosses them an even number of times.
Cut cut_edge(const std::vector<Vec3>& vertices, int from, int to, double k) {
  const Vec3& a = vertices[static_cast<std::size_t>(std::min(from, to))];
  const Vec3& b = vertices[static_cast<std::size_t>(std::max(from, to))];
  const double s = (k - a.z()) / (b.z() - a.z());
  return {a.y() + s * (b.y() - a.y()), a.x() + s * (b.x() - a.x())};
}

// A vertex or a cut that lies exactly on a slice or row counts as below it (half-open): no row is crossed twice.
void cross_facet(const IndexMesh& mesh, const std::array<int, 3>& t, int k, const Index3& size,
                 std::vector<Crossing>& out) {
  bool above[3];
  for (std::size_t c = 0; c < 3; ++c) above[c] = mesh.vertices[static_cast<std::size_t>(t[c])].z() > k;
  if (above[0] == above[1] && above[1] == above[2]) return;
  Cut up{}, down{};
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t d = (c + 1) % 3;
    if (above[c] == above[d]) continue;
    (above[d] ? up : down) = cut_edge(mesh.vertices, t[c], t[d], k);
  }
  // Counter-clockwise seen from outside: the edge that goes up is on the side of larger y where the outside is at
  // larger x.
  const bool leaving = down.y < up.y;
  const double lo = std::min(down.y, up.y), hi = std::max(down.y, up.y);
  const double first = std::max(std::ceil(lo), 0.0), last = std::min(std::ceil(hi) - 1.0, size[1] - 1.0);
  if (!(first <= last)) return;
  const double slope = (up.x - down.x) / (up.y - down.y);
  for (int j = static_cast<int>(first); j <= static_cast<int>(last); ++j) {
    // From the nearer end: no cancellation on long thin facets.
    const double x =
        std::abs(j - down.y) < std::abs(j - up.y) ? down.x + (j - down.y) * slope : up.x + (j - up.y) * slope;
    const double bounded = std::clamp(x, std::min(up.x, down.x), std::max(up.x, down.x));
    const double column = std::clamp(std::ceil(bounded), 0.0, static_cast<double>(size[0]));
    out.push_back({j, static_cast<int>(column), leaving ? -1 : 1});
  }
}

void fill_rows(const std::vector<Crossing>& crossings, std::uint8_t* slice, const Index3& size) {
  for (std::size_t i = 0; i < crossings.size();) {
    const int j = crossings[i].row;
    std::uint8_t* row = slice + static_cast<std::size_t>(j) * static_cast<std::size_t>(size[0]);
    int winding = 0, from = 0;
    for (; i < crossings.size() && crossings[i].row == j; ++i) {
      if (winding > 0) std::fill(row + from, row + crossings[i].column, std::uint8_t{1});
      winding += crossings[i].change;
      from = crossings[i].column;
    }
    if (winding > 0) std::fill(row + from, row + size[0], std::uint8_t{1});
  }
}

Image<std::uint8_t> winding_mask(const IndexMesh& mesh, const ImageGrid& grid) {
  Image<std::uint8_t> mask(grid);
  parallel_for(static_cast<std::size_t>(grid.size[2]), 4, [&](std::size_t begin, std::size_t end) {
    std::vector<Crossing> crossings;
    for (std::size_t k = begin; k < end; ++k) {
      crossings.clear();
      for (std::size_t i = mesh.slice_begin[k]; i < mesh.slice_begin[k + 1]; ++i) {
        const auto f = static_cast<std::size_t>(mesh.slice_triangles[i]);
        cross_facet(mesh, mesh.triangles[f], static_cast<int>(k), grid.size, crossings);
      }
      std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) {
        return a.row != b.row ? a.row < b.row : a.column < b.column;
      });
      fill_rows(crossings, &mask.at(0, 0, static_cast<int>(k)), grid.size);
    }
  });
  return mask;
}

}  // namespace

MaskResult rasterize_mask_checked(const TriangleMesh& surface, const ImageGrid& grid) {
  const IndexMesh mesh(surface, grid, 0.0, "cannot rasterise");
  const NodeMesh nodes{mesh.vertices, mesh.triangles};
  MaskResult out;
  out.mask = winding_mask(mesh, grid);
  out.mesh_volume_mm3 = volume_of(surface);
  const auto volume = [&](std::size_t count) { return static_cast<double>(count) * grid.voxel_volume(); };
  out.exact_volume_mm3 =
      volume(static_cast<std::size_t>(std::count(out.mask.voxels.begin(), out.mask.voxels.end(), std::uint8_t{1})));
  // A surface of which most lies elsewhere would cost OpenVDB more than the image.
  if (node_count_estimate(nodes, 1.5) > kSpareNodes + static_cast<double>(grid.voxel_count())) return out;
  const LevelSet::Comparison c = LevelSet(nodes, 1.5, LevelSet::Wanted::signs).compare(out.mask);
  out.openvdb_volume_mm3 = volume(c.inside);
  out.corrected_voxels = c.differ;
  const double limit = std::max(kLayer * area_of(nodes) * grid.voxel_volume(), kVolumeFraction * out.exact_volume_mm3);
  out.from_openvdb = std::abs(*out.openvdb_volume_mm3 - out.exact_volume_mm3) <= limit;
  return out;
}

Image<std::uint8_t> rasterize_mask(const TriangleMesh& surface, const ImageGrid& grid) {
  return winding_mask(IndexMesh(surface, grid, 0.0, "cannot rasterise"), grid);
}

}  // namespace pellicle
