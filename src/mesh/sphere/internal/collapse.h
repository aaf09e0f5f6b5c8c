#pragma once
/// A closed genus-0 mesh simplified edge by edge down to a tetrahedron, and refined again step by step: half-edge
/// collapses in the order of the quadric error. Source: Garland, Heckbert 1997 (error); Hoppe 1996 (progressive
/// meshes).

#include <vector>

#include "pellicle/mesh/triangle_mesh.h"

namespace pellicle {

/// One collapse: vertex `gone` was merged into its neighbour `kept`.
struct Collapse {
  int gone = -1, kept = -1;
  std::vector<int> moved;   ///< triangles in which `gone` became `kept`
  std::array<int, 2> lost;  ///< triangles that vanished; their corners stay as they were
};

/// Connectivity at some point of the sequence. Vertex and triangle numbers are those of the mesh.
class CollapsedMesh {
 public:
  /// Collapses all the way.
  /// \pre `mesh` is closed, manifold, oriented, connected, of genus 0 and without unused
  /// vertices.
  explicit CollapsedMesh(const TriangleMesh& mesh);

  int vertex_count() const { return alive_; }
  bool is_whole() const { return remaining_.empty(); }
  /// Undoes the last collapse and returns its vertex.
  /// \pre !is_whole().
  const Collapse& split();
  /// Triangles around a vertex that is there.
  const std::vector<int>& triangles_at(int vertex) const { return at_[static_cast<std::size_t>(vertex)]; }
  const std::array<int, 3>& triangle(int t) const { return triangles_[static_cast<std::size_t>(t)]; }
  bool has_triangle(int t) const { return !gone_[static_cast<std::size_t>(t)]; }
  bool has_vertex(int v) const { return !at_[static_cast<std::size_t>(v)].empty(); }
  int all_triangles() const { return static_cast<int>(triangles_.size()); }
  int all_vertices() const { return static_cast<int>(at_.size()); }

 private:
  friend class Collapser;
  std::vector<std::array<int, 3>> triangles_;
  std::vector<bool> gone_;
  std::vector<std::vector<int>> at_;
  std::vector<Collapse> remaining_;
  Collapse last_;
  int alive_ = 0;
};

}  // namespace pellicle
