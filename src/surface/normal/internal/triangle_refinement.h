#pragma once
/// How one control triangle is split 1 -> 4 again and again: which local vertices there are, in which order they come
/// into being and from which others. The same for every control triangle.

#include <array>
#include <vector>

namespace pellicle {

/// A vertex on the middle of the edge a -> b. `left` and `right` are the vertices opposite to that edge in the two
/// triangles beside it (of the level that is refined), -1 where there is none inside the control triangle.
struct RefinedVertex {
  int a = -1, b = -1, left = -1, right = -1;
};

/// Local vertices 0..2 are the corners. Those of step k (1..level) come after all of step k-1: first the ones on the
/// control edges (edge i runs from corner i to corner i+1), edge by edge, then the ones inside.
struct TriangleRefinement {
  struct Step {
    std::array<int, 4> edge_begin;  ///< on control edge i: [edge_begin[i], edge_begin[i+1])
    int end = 0;                    ///< inside: [edge_begin[3], end)
  };

  int level = 0;
  std::vector<Step> steps;                      ///< steps[k-1] is step k
  std::vector<RefinedVertex> vertices;          ///< the corners have no parents
  std::vector<std::array<int, 3>> barycentric;  ///< sums to 2^level
  std::vector<std::array<int, 3>> triangles;    ///< of the last level, oriented like the control triangle

  int vertex_count() const { return static_cast<int>(vertices.size()); }
  /// Vertices of all steps but the last (always the corners): those that others may depend on.
  int coarse_count() const { return level == 0 ? 3 : steps.back().edge_begin[0]; }
  /// The control edge that the vertex lies inside of, or -1 for corners and for vertices inside the triangle.
  int control_edge(int vertex) const;
};

/// \param level 0 and above; 4^level triangles.
TriangleRefinement refine_triangle(int level);

}  // namespace pellicle
