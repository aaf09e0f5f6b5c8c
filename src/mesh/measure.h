#pragma once
/// Area, volume and centroid of a mesh, its topology, and where it cuts itself.

#include <array>
#include <cstddef>
#include <string>

#include "pellicle/mesh/triangle_mesh.h"

namespace pellicle {

/// \throws BadData naming the first facet with a vertex that does not exist, or the first coordinate that is not
/// finite.
void check_indices(const TriangleMesh& mesh);
/// \throws BadData naming the first edge that is open, or not used equally often in both directions; `what` begins the
/// message.
void require_closed(const TriangleMesh& mesh, const std::string& what);

double area_of(const TriangleMesh& mesh);  ///< mm^2
/// Divergence theorem on flat facets, mm^3; positive for outward orientation. Meaningful for closed meshes only.
double volume_of(const TriangleMesh& mesh);
/// Turns a closed mesh whose volume is negative inside out.
void turn_outward(TriangleMesh& mesh);
/// 4th order in the facet size where vertex normals are exact (models.md 1.7): flat volume plus the mean height of the
/// cubic patch over each facet.
/// \pre normals are present.
double volume_with_normals(const TriangleMesh& mesh);
Vec3 centroid_of(const TriangleMesh& mesh);  ///< of the enclosed solid

/// Connectivity: closed, manifold, oriented, and the counts that follow.
struct MeshTopology {
  bool closed = false;    ///< every edge has exactly two facets
  bool manifold = false;  ///< no edge with more than two facets, one fan per vertex
  bool oriented = false;  ///< every inner edge is used once in each direction
  int components = 0;
  int euler = 0;            ///< V - E + F (vertices in use)
  int border_loops = 0;     ///< rings of open edges; valid when manifold and oriented
  int genus = 0;            ///< sum over components, border loops closed by discs; valid as border_loops is
  std::string first_fault;  ///< e.g. "edge 12-57 has 3 facets"; empty when all is well
};
MeshTopology topology_of(const TriangleMesh& mesh);

/// The rings of open edges of manifold, oriented facets: vertices in order, the surface to the left.
std::vector<std::vector<int>> border_loops(const std::vector<std::array<int, 3>>& triangles);

/// Pairs of facets that meet where they should not: without a common vertex, in any point; with one common vertex, in
/// another point too. Pairs that share an edge are neighbours and never count. Vertices are the same when their
/// coordinates are (candidates from Embree's collision, then an exact test).
std::size_t self_intersection_count(const TriangleMesh& mesh);
/// The pairs themselves, the lower facet first, in ascending order.
std::vector<std::array<int, 2>> self_intersections(const TriangleMesh& mesh);

}  // namespace pellicle
