// Exact cover: facets are cut at the faces of the voxels, and the pieces are summed by the divergence theorem. In voxel
// i of a row the field F = (clamp(x - i, 0, 1), 0, 0), x from the voxel's lower face, has divergence 1 inside the voxel
// and 0 elsewhere, and no flux through the walls of the row, so that
//   fraction(i) = sum of pieces in voxel i: a (xbar - i)  +  sum of pieces beyond it: a,
// a = area of the piece seen along x, positive where the outside is at larger x, xbar = its centroid. (Font renderers
// cover pixels in the same way in 2D.) Their sum is the volume of the mesh to rounding, whatever the grid.
#include <algorithm>
#include <cmath>

#include "pellicle/base/parallel.h"
#include "pellicle/raster/internal/index_mesh.h"
#include "pellicle/raster/rasterize.h"

namespace pellicle {

namespace {

using Point = std::array<double, 3>;

// A convex piece of a facet: at most 3 corners and one more per cut.
struct Polygon {
  std::array<Point, 10> corner{};
  int size = 0;
  void push(const Point& x) { corner[static_cast<std::size_t>(size++)] = x; }
  double lowest(std::size_t axis) const {
    double v = corner[0][axis];
    for (int i = 1; i < size; ++i) v = std::min(v, corner[static_cast<std::size_t>(i)][axis]);
    return v;
  }
  double highest(std::size_t axis) const {
    double v = corner[0][axis];
    for (int i = 1; i < size; ++i) v = std::max(v, corner[static_cast<std::size_t>(i)][axis]);
    return v;
  }
};

// Splits at the plane x[axis] = at. Points on the plane go to both sides.
void split(const Polygon& in, std::size_t axis, double at, Polygon& below, Polygon& above) {
  below.size = above.size = 0;
  for (int i = 0; i < in.size; ++i) {
    const Point& p = in.corner[static_cast<std::size_t>(i)];
    const Point& q = in.corner[static_cast<std::size_t>(i + 1 == in.size ? 0 : i + 1)];
    const double dp = p[axis] - at, dq = q[axis] - at;
    if (dp <= 0.0) below.push(p);
    if (dp >= 0.0) above.push(p);
    if ((dp < 0.0 && dq > 0.0) || (dp > 0.0 && dq < 0.0)) {
      const double s = dp / (dp - dq);
      Point x = {p[0] + s * (q[0] - p[0]), p[1] + s * (q[1] - p[1]), p[2] + s * (q[2] - p[2])};
      x[axis] = at;
      below.push(x);
      above.push(x);
    }
  }
}

// Calls `visit(cell, piece)` for the pieces of `polygon` within each cell [c, c+1) of an axis, first <= c < end; what
// lies below is dropped, what lies above goes to `end` in one piece.
template <class Visit>
void for_each_cell(Polygon polygon, std::size_t axis, int first, int end, const Visit& visit) {
  Polygon below, above;
  const double hi = polygon.highest(axis);
  if (polygon.size < 3 || hi < first) return;
  double cell =
      std::clamp(std::floor(polygon.lowest(axis)), static_cast<double>(first) - 1.0, static_cast<double>(end));
  if (cell < first) {
    split(polygon, axis, first, below, above);
    polygon = above;
    cell = first;
  }
  for (int c = static_cast<int>(cell); c < end && polygon.size >= 3; ++c) {
    if (hi <= c + 1) {
      visit(c, polygon);
      return;
    }
    split(polygon, axis, c + 1.0, below, above);
    if (below.size >= 3) visit(c, below);
    polygon = above;
  }
  if (polygon.size >= 3) visit(end, polygon);
}

// One slab of voxels: rows of nx + 1 cells, the last one for what lies beyond.
class Slab {
 public:
  explicit Slab(const Index3& size)
      : size_(size),
        stride_(static_cast<std::size_t>(size[0]) + 1),
        inner_(stride_ * static_cast<std::size_t>(size[1])),
        cover_(inner_.size()) {}

  void clear() {
    std::fill(inner_.begin(), inner_.end(), 0.0);
    std::fill(cover_.begin(), cover_.end(), 0.0);
  }

  void add(const Polygon& facet, int k) {
    // The slab itself is the only cell wanted along z.
    for_each_cell(facet, 2, k, k + 1, [&](int slab, const Polygon& slice) {
      if (slab != k) return;
      for_each_cell(slice, 1, 0, size_[1], [&](int j, const Polygon& strip) {
        if (j == size_[1]) return;
        const std::size_t row = static_cast<std::size_t>(j) * stride_;
        // Below the first voxel nothing is covered, so the pieces there may go.
        for_each_cell(strip, 0, 0, size_[0], [&](int i, const Polygon& piece) { add_piece(row, i, j, k, piece); });
      });
    });
  }

  void write(float* out) const {
    for (std::size_t row = 0; row < inner_.size(); row += stride_, out += size_[0]) {
      double beyond = cover_[row + stride_ - 1];
      for (std::size_t i = stride_ - 1; i-- > 0;) {
        const double fraction = inner_[row + i] + beyond;
        beyond += cover_[row + i];
        // Rounding of the sums; where a surface overlaps itself the cover exceeds 1.
        out[i] = fraction < 1e-9 ? 0.0F : fraction > 1.0 - 1e-9 ? 1.0F : static_cast<float>(fraction);
      }
    }
  }

 private:
  void add_piece(std::size_t row, int i, int j, int k, const Polygon& piece) {
    // Fan of triangles about the first corner, relative to the voxel.
    const auto from_voxel = [&](int n) {
      const Point& x = piece.corner[static_cast<std::size_t>(n)];
      return Vec3(x[0] - i, x[1] - j, x[2] - k);
    };
    const Vec3 a = from_voxel(0);
    double area = 0.0, moment = 0.0;
    for (int n = 2; n < piece.size; ++n) {
      const Vec3 b = from_voxel(n - 1), c = from_voxel(n);
      const double part = 0.5 * ((b.y() - a.y()) * (c.z() - a.z()) - (b.z() - a.z()) * (c.y() - a.y()));
      area += part;
      moment += part * (a.x() + b.x() + c.x()) / 3.0;
    }
    cover_[row + static_cast<std::size_t>(i)] += area;
    if (i < size_[0]) inner_[row + static_cast<std::size_t>(i)] += moment;
  }

  Index3 size_;
  std::size_t stride_;
  std::vector<double> inner_;  ///< of the piece's own voxel
  std::vector<double> cover_;  ///< of every voxel before it
};

}  // namespace

Image<float> rasterize_partial_volume(const TriangleMesh& surface, const ImageGrid& grid) {
  const IndexMesh mesh(surface, grid, 0.5, "cannot rasterise");
  Image<float> out(grid);
  parallel_for(static_cast<std::size_t>(grid.size[2]), 4, [&](std::size_t begin, std::size_t end) {
    Slab slab(grid.size);
    for (std::size_t k = begin; k < end; ++k) {
      if (mesh.slice_begin[k] == mesh.slice_begin[k + 1]) continue;
      slab.clear();
      for (std::size_t i = mesh.slice_begin[k]; i < mesh.slice_begin[k + 1]; ++i) {
        Polygon facet;
        for (const int v : mesh.triangles[static_cast<std::size_t>(mesh.slice_triangles[i])]) {
          const Vec3& x = mesh.vertices[static_cast<std::size_t>(v)];
          facet.push({x.x() + 0.5, x.y() + 0.5, x.z() + 0.5});  // voxel i covers [i, i + 1)
        }
        slab.add(facet, static_cast<int>(k));
      }
      slab.write(&out.at(0, 0, static_cast<int>(k)));
    }
  });
  return out;
}

}  // namespace pellicle
