// Marching cubes (Lorensen and Cline 1987) without a table: in each cell the loops of the surface are followed along
// the faces. On a face with two diagonal corners inside, these are kept apart, always: neighbouring cells agree, so the
// surface is closed, and one vertex per grid edge makes it manifold.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pellicle/raster/rasterize.h"

namespace pellicle {

namespace {

// Corner c of a cell is at (c & 1, c >> 1 & 1, c >> 2); edge number = 3 * lower corner + axis.

// The corners of the six faces, counter-clockwise seen from outside the cell.
constexpr int kNarrow[5] = {0, 1, 2, 1, 0}, kWide[5] = {1, 4, 6, 4, 1};  // B, sum 4, and B * B, sum 16
constexpr int kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};

int edge_number(int a, int b) {
  const int lower = std::min(a, b), axis = (a ^ b) >> 1;  // 1, 2, 4 -> 0, 1, 2
  return 3 * lower + axis;
}

// For each of the 24 edge numbers, the edge that follows it in its loop in this cell, or -1. Seen from outside the
// cell, walking round a face counter-clockwise, the surface runs from where the walk leaves the solid to where it came
// in: that keeps the solid on the left, and cuts off each run of inside corners by itself.
std::array<int, 24> loops_of(unsigned inside) {
  std::array<int, 24> next{};
  next.fill(-1);
  for (const auto& face : kFaces) {
    for (int c = 0; c < 4; ++c) {
      const bool here = (inside >> face[c] & 1U) != 0, after = (inside >> face[(c + 1) % 4] & 1U) != 0;
      if (!here || after) continue;
      int start = c;  // back to the first corner of this run
      while ((inside >> face[(start + 3) % 4] & 1U) != 0) start = (start + 3) % 4;
      const int leave = edge_number(face[c], face[(c + 1) % 4]);
      const int enter = edge_number(face[(start + 3) % 4], face[start]);
      next[static_cast<std::size_t>(enter)] = leave;
    }
  }
  return next;
}

// Whether two edges of the cell lie on one face: a diagonal between them could meet the neighbour's there.
bool share_face(int e, int f) {
  const auto corners = [](int n) { return std::pair(n / 3, n / 3 | 1 << n % 3); };
  const auto [a, b] = corners(e);
  const auto [c, d] = corners(f);
  const int all_ones = a & b & c & d, all_zeros = ~(a | b | c | d) & 7;
  return all_ones != 0 || all_zeros != 0;
}

class MaskSurface {
 public:
  explicit MaskSurface(const Image<std::uint8_t>& mask) : mask_(mask) {
    for (unsigned c = 0; c < 256; ++c) loops_[c] = loops_of(c);
  }

  TriangleMesh run() {
    if (!find_box()) return {};
    const std::size_t nodes = static_cast<std::size_t>(width(0)) * static_cast<std::size_t>(width(1));
    for (auto& layer : ids_) layer.assign(3 * nodes, -1);
    for (int k = lo_[2]; k < hi_[2]; ++k) {
      for (int j = lo_[1]; j < hi_[1]; ++j) add_row(j, k);
      std::swap(ids_[0], ids_[1]);
      std::fill(ids_[1].begin(), ids_[1].end(), -1);
    }
    const bool mirrored = mask_.grid.world_from_index_matrix().determinant() < 0.0;
    for (Vec3& v : mesh_.vertices) v = mask_.grid.world_from_index(v);
    if (mirrored) {
      for (auto& t : mesh_.triangles) std::swap(t[1], t[2]);
    }
    return std::move(mesh_);
  }

 private:
  int width(std::size_t a) const { return hi_[a] - lo_[a] + 1; }

  bool inside(int i, int j, int k) const {
    const Index3& n = mask_.grid.size;
    return i >= 0 && j >= 0 && k >= 0 && i < n[0] && j < n[1] && k < n[2] && mask_.at(i, j, k) != 0;
  }

  // Nodes lo_ .. hi_: the solid and one voxel of outside around it, beyond the image where it touches the border.
  bool find_box() {
    lo_ = {std::numeric_limits<int>::max(), std::numeric_limits<int>::max(), std::numeric_limits<int>::max()};
    hi_ = {-1, -1, -1};
    const Index3& n = mask_.grid.size;
    for (int k = 0; k < n[2]; ++k) {
      for (int j = 0; j < n[1]; ++j) {
        const std::uint8_t* row = &mask_.at(0, j, k);
        const auto any = [](std::uint8_t v) { return v != 0; };
        const std::uint8_t* first = std::find_if(row, row + n[0], any);
        if (first == row + n[0]) continue;
        const std::uint8_t* last = row + n[0] - 1;
        while (*last == 0) --last;
        lo_ = {std::min(lo_[0], static_cast<int>(first - row)), std::min(lo_[1], j), std::min(lo_[2], k)};
        hi_ = {std::max(hi_[0], static_cast<int>(last - row)), std::max(hi_[1], j), std::max(hi_[2], k)};
      }
    }
    if (hi_[2] < 0) return false;
    for (std::size_t a = 0; a < 3; ++a) {
      --lo_[a];
      ++hi_[a];
    }
    return true;
  }

  void add_row(int j, int k) {
    unsigned column[2] = {0, 0};  // corners at x = i and x = i + 1, as bits y + 2 z
    const auto corners_at = [&](int i) {
      return static_cast<unsigned>(inside(i, j, k)) | static_cast<unsigned>(inside(i, j + 1, k)) << 1 |
             static_cast<unsigned>(inside(i, j, k + 1)) << 2 | static_cast<unsigned>(inside(i, j + 1, k + 1)) << 3;
    };
    column[1] = corners_at(lo_[0]);
    for (int i = lo_[0]; i < hi_[0]; ++i) {
      column[0] = column[1];
      column[1] = corners_at(i + 1);
      if (column[0] == column[1] && (column[0] == 0 || column[0] == 15)) continue;
      unsigned cell = 0;
      for (unsigned b = 0; b < 4; ++b) cell |= (column[0] >> b & 1U) << (2 * b) | (column[1] >> b & 1U) << (2 * b + 1);
      add_cell({i, j, k}, loops_[cell]);
    }
  }

  void add_cell(const Index3& cell, std::array<int, 24> next) {
    for (std::size_t e = 0; e < 24; ++e) {
      if (next[e] < 0) continue;
      std::vector<int>& loop = loop_;
      loop.clear();
      for (auto at = e; next[at] >= 0;) {
        loop.push_back(static_cast<int>(at));
        at = static_cast<std::size_t>(std::exchange(next[at], -1));
      }
      add_loop(cell, loop);
    }
  }

  void add_loop(const Index3& cell, const std::vector<int>& loop) {
    corner_.clear();
    for (const int e : loop) corner_.push_back(vertex_on(cell, e));
    if (loop.size() == 3) {
      mesh_.triangles.push_back({corner_[0], corner_[1], corner_[2]});
    } else if (loop.size() == 4 && !share_face(loop[0], loop[2])) {
      mesh_.triangles.push_back({corner_[0], corner_[1], corner_[2]});
      mesh_.triangles.push_back({corner_[0], corner_[2], corner_[3]});
    } else {
      // About a vertex of its own: no diagonal that a neighbour might have too.
      Vec3 centre = Vec3::Zero();
      for (const int v : corner_) centre += mesh_.vertices[static_cast<std::size_t>(v)];
      const int hub = static_cast<int>(mesh_.vertices.size());
      mesh_.vertices.emplace_back(centre / static_cast<double>(loop.size()));
      for (std::size_t c = 0; c < corner_.size(); ++c) {
        mesh_.triangles.push_back({hub, corner_[c], corner_[(c + 1) % corner_.size()]});
      }
    }
  }

  int vertex_on(const Index3& cell, int edge) {
    const int corner = edge / 3, axis = edge % 3;
    const Index3 node = {cell[0] + (corner & 1), cell[1] + (corner >> 1 & 1), cell[2] + (corner >> 2)};
    const std::size_t at = static_cast<std::size_t>(node[1] - lo_[1]) * static_cast<std::size_t>(width(0)) +
                           static_cast<std::size_t>(node[0] - lo_[0]);
    int& id = ids_[static_cast<std::size_t>(corner >> 2)][3 * at + static_cast<std::size_t>(axis)];
    if (id < 0) {
      id = static_cast<int>(mesh_.vertices.size());
      Vec3 x(node[0], node[1], node[2]);
      x[axis] += crossing(node, axis);
      mesh_.vertices.push_back(x);
    }
    return id;
  }

  // How much of the neighbourhood is inside, less one half: the mask under 2 B - B * B, B = the binomial weights 1 2 1
  // along each axis. B alone would move a surface towards its centre of curvature by a quarter of the sum of its
  // curvatures; this combination has no second moment and leaves a sphere where it is.
  int excess(const Index3& node) const {
    const Index3& n = mask_.grid.size;
    int sum = 0;
    for (int c = 0; c < 5; ++c) {
      const int k = node[2] + c - 2;
      if (k < 0 || k >= n[2]) continue;
      for (int b = 0; b < 5; ++b) {
        const int j = node[1] + b - 2;
        if (j < 0 || j >= n[1]) continue;
        const std::uint8_t* row = &mask_.at(0, j, k);
        const int first = std::max(0, 2 - node[0]), end = std::min(5, n[0] + 2 - node[0]);
        const int narrow = 128 * kNarrow[b] * kNarrow[c], wide = kWide[b] * kWide[c];
        for (int a = first; a < end; ++a) {
          if (row[node[0] + a - 2] != 0) sum += narrow * kNarrow[a] - wide * kWide[a];
        }
      }
    }
    return sum - 2048;
  }

  // Where on the edge from `node` the surface crosses, 0..1. The mask only says: between the two centres. On a slope
  // the neighbours say more; where they would take the voxel away (thin parts, tips), the middle stands.
  double crossing(const Index3& node, int axis) const {
    Index3 far = node;
    ++far[static_cast<std::size_t>(axis)];
    const double a = excess(node), b = excess(far);  // in 1/4096
    const bool a_inside = inside(node[0], node[1], node[2]);
    if (a_inside ? !(a > 0.0 && b < 0.0) : !(a < 0.0 && b > 0.0)) return 0.5;
    return std::clamp(a / (a - b), 0.05, 0.95);
  }

  const Image<std::uint8_t>& mask_;
  Index3 lo_{}, hi_{};
  std::array<std::array<int, 24>, 256> loops_{};
  std::array<std::vector<int>, 2> ids_;  ///< vertex on each edge that starts in the lower and the upper node layer
  std::vector<int> loop_, corner_;
  TriangleMesh mesh_;
};

}  // namespace

TriangleMesh surface_of_mask(const Image<std::uint8_t>& mask) {
  return MaskSurface(mask).run();
}

}  // namespace pellicle
