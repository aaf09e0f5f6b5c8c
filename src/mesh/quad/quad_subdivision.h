#pragma once
/// Catmull-Clark on quad meshes as constant weights: one step, and the limit at the vertices.
/// Source: Catmull, Clark 1978; limit masks Halstead, Kass, DeRose 1993 (docs/any-topology.md).

#include "pellicle/mesh/quad/point_rows.h"
#include "pellicle/mesh/quad/quad_mesh.h"

namespace pellicle {

/// One step. New vertices: the old ones (same numbers), one per edge, one per quad, in the topology's order. Quad 4f +
/// c is the one at corner c of quad f: [corner, point of the edge after it, point of the quad, point of the edge
/// before].
struct QuadStep {
  PointRows rows;
  std::vector<Quad> quads;
};
/// Borders become uniform cubic B-spline curves; border vertices of one quad only are corners and stay where they are.
QuadStep catmull_clark_step(const QuadTopology& topology);

/// The limit surface at each vertex: position, and two tangents whose cross product points outward (their lengths mean
/// nothing; empty rows on a border).
struct LimitMasks {
  PointRows position, tangent_u, tangent_v;
};
LimitMasks catmull_clark_limit(const QuadTopology& topology);

}  // namespace pellicle
