#include "pellicle/mesh/quad/quad_subdivision.h"

#include <cmath>
#include <numbers>

namespace pellicle {
namespace {

bool is_corner(const QuadRing& ring) {
  return !ring.closed && ring.quad.size() == 1;
}

/// (F + 2 E + (n - 3) V) / n, F the mean of the quads' points, E of the edges' midpoints.
void add_vertex_row(const QuadTopology& topology, int v, PointRows& rows) {
  const QuadRing& ring = topology.rings[static_cast<std::size_t>(v)];
  if (!ring.closed) {
    const double beside = is_corner(ring) ? 0.0 : 0.125;
    rows.add(v, 1 - 2 * beside);
    rows.add(ring.edge.front(), beside);
    rows.add(ring.edge.back(), beside);
    rows.close();
    return;
  }
  const double n = ring.valence();
  // V: (n-3)/n, half of 2/n from the midpoints, a quarter of 1/n from the quads
  rows.add(v, (n - 3 + 1 + 0.25) / n);
  for (const int e : ring.edge) rows.add(e, (1 + 0.5) / (n * n));  // in its midpoint and in two quads
  for (const int d : ring.diagonal) rows.add(d, 0.25 / (n * n));
  rows.close();
}

void add_edge_row(const QuadTopology& topology, const QuadEdge& edge, PointRows& rows) {
  if (edge.on_border()) {
    rows.add(edge.a, 0.5);
    rows.add(edge.b, 0.5);
    rows.close();
    return;
  }
  rows.add(edge.a, 0.375);
  rows.add(edge.b, 0.375);
  for (const int f : edge.quads) {
    for (const int v : topology.quads[static_cast<std::size_t>(f)]) {
      if (v != edge.a && v != edge.b) rows.add(v, 0.0625);
    }
  }
  rows.close();
}

}  // namespace

QuadStep catmull_clark_step(const QuadTopology& topology) {
  QuadStep step;
  const int vertices = topology.vertex_count(), edges = static_cast<int>(topology.edges.size());
  for (int v = 0; v < vertices; ++v) add_vertex_row(topology, v, step.rows);
  for (const QuadEdge& edge : topology.edges) add_edge_row(topology, edge, step.rows);
  for (const Quad& quad : topology.quads) {
    for (const int v : quad) step.rows.add(v, 0.25);
    step.rows.close();
  }
  step.quads.reserve(4 * topology.quads.size());
  for (std::size_t f = 0; f < topology.quads.size(); ++f) {
    for (std::size_t c = 0; c < 4; ++c) {
      step.quads.push_back({topology.quads[f][c], vertices + topology.quad_edges[f][c],
                            vertices + edges + static_cast<int>(f), vertices + topology.quad_edges[f][(c + 3) % 4]});
    }
  }
  return step;
}

LimitMasks catmull_clark_limit(const QuadTopology& topology) {
  LimitMasks masks;
  for (int v = 0; v < topology.vertex_count(); ++v) {
    const QuadRing& ring = topology.rings[static_cast<std::size_t>(v)];
    const auto n = static_cast<double>(ring.valence());
    if (!ring.closed) {
      const double beside = is_corner(ring) ? 0.0 : 1.0 / 6;
      masks.position.add(v, 1 - 2 * beside);
      masks.position.add(ring.edge.front(), beside);
      masks.position.add(ring.edge.back(), beside);
    } else {
      const double angle = 2 * std::numbers::pi / n, c = std::cos(angle);
      const double amplitude = 1 + c + std::cos(angle / 2) * std::sqrt(2 * (9 + c));
      masks.position.add(v, n / (n + 5));
      for (std::size_t i = 0; i < ring.edge.size(); ++i) {
        const double at = angle * static_cast<double>(i), next = at + angle;
        masks.position.add(ring.edge[i], 4 / (n * (n + 5)));
        masks.position.add(ring.diagonal[i], 1 / (n * (n + 5)));
        masks.tangent_u.add(ring.edge[i], amplitude * std::cos(at));
        masks.tangent_u.add(ring.diagonal[i], std::cos(at) + std::cos(next));
        masks.tangent_v.add(ring.edge[i], amplitude * std::sin(at));
        masks.tangent_v.add(ring.diagonal[i], std::sin(at) + std::sin(next));
      }
    }
    masks.position.close();
    masks.tangent_u.close();
    masks.tangent_v.close();
  }
  return masks;
}

}  // namespace pellicle
