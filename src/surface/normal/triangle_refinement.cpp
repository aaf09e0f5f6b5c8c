#include "pellicle/surface/normal/internal/triangle_refinement.h"

namespace pellicle {
namespace {

/// Numbers of the lattice points (i, j, k), i + j + k = 2^level.
class Lattice {
 public:
  explicit Lattice(int level) : size_(1 << level), number_((size_ + 1) * (size_ + 1), -1) {}
  int size() const { return size_; }
  int& operator()(const std::array<int, 3>& at) { return number_[at[1] * (size_ + 1) + at[2]]; }

 private:
  int size_;
  std::vector<int> number_;
};

std::array<int, 3> moved(std::array<int, 3> at, int axis, int by_axis, int by_next, int by_last) {
  at[axis] += by_axis;
  at[(axis + 1) % 3] += by_next;
  at[(axis + 2) % 3] += by_last;
  return at;
}

/// The vertex at `at`, new in the step whose lattice has the given spacing: two of its coordinates, counted in that
/// spacing, are odd, and its edge runs along them.
void add_vertex(const std::array<int, 3>& at, int spacing, Lattice& lattice, TriangleRefinement& result) {
  int axis = 0;  // the edge runs from the side of corner `axis` to that of corner axis + 1
  while (at[axis] / spacing % 2 == 0 || at[(axis + 1) % 3] / spacing % 2 == 0) ++axis;
  RefinedVertex vertex;
  vertex.a = lattice(moved(at, axis, spacing, -spacing, 0));
  vertex.b = lattice(moved(at, axis, -spacing, spacing, 0));
  if (at[(axis + 2) % 3] > 0) {
    vertex.left = lattice(moved(at, axis, -spacing, -spacing, 2 * spacing));
    vertex.right = lattice(moved(at, axis, spacing, spacing, -2 * spacing));
  }
  lattice(at) = result.vertex_count();
  result.vertices.push_back(vertex);
  result.barycentric.push_back(at);
}

TriangleRefinement::Step add_step(int spacing, Lattice& lattice, TriangleRefinement& result) {
  const int size = lattice.size();
  TriangleRefinement::Step step;
  for (int edge = 0; edge < 3; ++edge) {
    step.edge_begin[edge] = result.vertex_count();
    for (int j = spacing; j < size; j += 2 * spacing) {
      std::array<int, 3> at{};
      at[edge] = size - j;
      at[(edge + 1) % 3] = j;
      add_vertex(at, spacing, lattice, result);
    }
  }
  step.edge_begin[3] = result.vertex_count();
  for (int j = spacing; j < size; j += spacing) {
    for (int k = spacing; j + k < size; k += spacing) {
      const bool older = j / spacing % 2 == 0 && k / spacing % 2 == 0;
      if (!older) add_vertex({size - j - k, j, k}, spacing, lattice, result);
    }
  }
  step.end = result.vertex_count();
  return step;
}

}  // namespace

int TriangleRefinement::control_edge(int vertex) const {
  if (vertex < 3) return -1;
  for (int edge = 0; edge < 3; ++edge) {
    if (barycentric[vertex][(edge + 2) % 3] == 0) return edge;
  }
  return -1;
}

TriangleRefinement refine_triangle(int level) {
  TriangleRefinement result;
  result.level = level;
  Lattice lattice(level);
  const int size = lattice.size();
  for (int corner = 0; corner < 3; ++corner) {
    std::array<int, 3> at{};
    at[corner] = size;
    lattice(at) = corner;
    result.vertices.emplace_back();
    result.barycentric.push_back(at);
  }
  for (int spacing = size / 2; spacing >= 1; spacing /= 2) result.steps.push_back(add_step(spacing, lattice, result));
  for (int j = 0; j < size; ++j) {
    for (int k = 0; j + k < size; ++k) {
      const int i = size - j - k;
      const int corner = lattice({i, j, k}), next = lattice({i - 1, j + 1, k}), last = lattice({i - 1, j, k + 1});
      result.triangles.push_back({corner, next, last});
      if (i >= 2) result.triangles.push_back({next, lattice({i - 2, j + 1, k + 1}), last});
    }
  }
  return result;
}

}  // namespace pellicle
