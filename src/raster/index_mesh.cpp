#include "pellicle/raster/internal/index_mesh.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pellicle/mesh/measure.h"

namespace pellicle {

IndexMesh::IndexMesh(const TriangleMesh& surface, const ImageGrid& grid, double reach, const std::string& what)
    : triangles(surface.triangles) {
  require_closed(surface, what);
  vertices.reserve(surface.vertices.size());
  for (const Vec3& v : surface.vertices) vertices.push_back(grid.index_from_world(v));
  if (grid.world_from_index_matrix().determinant() < 0.0) {
    for (auto& t : triangles) std::swap(t[1], t[2]);
  }
  // Counting sort by slice. Clamped as doubles: a surface far outside must not overflow an int.
  const double last = grid.size[2] - 1;
  const auto slices_of = [&](const std::array<int, 3>& t) {
    double lo = vertices[static_cast<std::size_t>(t[0])].z(), hi = lo;
    for (const int i : t) {
      lo = std::min(lo, vertices[static_cast<std::size_t>(i)].z());
      hi = std::max(hi, vertices[static_cast<std::size_t>(i)].z());
    }
    const double first = std::max(std::ceil(lo - reach), 0.0), end = std::min(std::floor(hi + reach), last) + 1.0;
    return first < end ? std::pair(static_cast<std::size_t>(first), static_cast<std::size_t>(end))
                       : std::pair<std::size_t, std::size_t>(0, 0);
  };
  slice_begin.assign(static_cast<std::size_t>(grid.size[2]) + 1, 0);
  for (const auto& t : triangles) {
    const auto [first, end] = slices_of(t);
    for (std::size_t k = first; k < end; ++k) ++slice_begin[k + 1];
  }
  for (std::size_t k = 1; k < slice_begin.size(); ++k) slice_begin[k] += slice_begin[k - 1];
  slice_triangles.resize(slice_begin.back());
  std::vector<std::size_t> next(slice_begin.begin(), slice_begin.end() - 1);
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    const auto [first, end] = slices_of(triangles[f]);
    for (std::size_t k = first; k < end; ++k) slice_triangles[next[k]++] = static_cast<int>(f);
  }
}

}  // namespace pellicle
