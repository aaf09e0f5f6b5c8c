#pragma once
/// Meshes of four-sided facets in LPS mm: control meshes of the surfaces of any topology. A plain value; algorithms are
/// free functions.

#include <array>
#include <vector>

#include "pellicle/mesh/triangle_mesh.h"

namespace pellicle {

using Quad = std::array<int, 4>;  ///< vertices, counter-clockwise seen from outside

struct QuadMesh {
  std::vector<Vec3> vertices;
  std::vector<Quad> quads;
};

/// What surrounds a vertex, counter-clockwise seen from outside.
struct QuadRing {
  std::vector<int> edge;      ///< neighbours along edges
  std::vector<int> diagonal;  ///< opposite corner of the quad between edge[i] and edge[i + 1] (cyclic when closed)
  std::vector<int> quad;      ///< that quad
  bool closed = true;         ///< false on a border: one edge more than quads, from border to border
  int valence() const { return static_cast<int>(edge.size()); }
};

struct QuadEdge {
  int a = 0, b = 0;                  ///< a < b
  std::array<int, 2> quads{-1, -1};  ///< the second is -1 on a border
  bool on_border() const { return quads[1] < 0; }
};

/// Connectivity of a manifold, oriented quad mesh.
struct QuadTopology {
  std::vector<Quad> quads;
  std::vector<QuadRing> rings;                 ///< one per vertex
  std::vector<QuadEdge> edges;                 ///< ordered by (a, b)
  std::vector<std::array<int, 4>> quad_edges;  ///< edge from corner i to corner i + 1 of each quad
  int components = 0;
  int euler = 0;         ///< V - E + F
  int border_loops = 0;  ///< 0: closed
  int genus = 0;         ///< sum over the components: handles, border loops not counted
  int vertex_count() const { return static_cast<int>(rings.size()); }
  bool closed() const { return border_loops == 0; }
};

enum class Border { refused, allowed };

/// \throws BadData naming the first fault: no quads, a missing vertex, a vertex twice in a quad or in none, an edge of
/// more than two quads, quads of opposite orientations (and whether turning some round would help), sheets that
/// touch in a vertex, a vertex inside of two quads only, an open edge when borders are refused.
QuadTopology quad_topology(int vertex_count, const std::vector<Quad>& quads, Border border = Border::refused);

/// Each quad split along the shorter diagonal, or, given unit normals, along the one whose ends' normals agree better.
/// Normals are carried over.
TriangleMesh split_quads(const QuadMesh& mesh, const std::vector<Vec3>& normals = {});

/// Corners of a cube on the unit sphere: 8 vertices, 6 quads.
QuadMesh cube_mesh();
/// A grid on a torus about the z axis.
/// \param around quads around the axis.
/// \param across quads around the tube.
/// \pre around, across >= 3.
QuadMesh torus_mesh(int around, int across, double major, double minor);

}  // namespace pellicle
