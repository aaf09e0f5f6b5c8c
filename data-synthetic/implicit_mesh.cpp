#include "pellicle/synthetic/implicit_mesh.h"

#include <cmath>
#include <cstddef>
#include <utility>

#include "pellicle/base/parallel.h"

namespace pellicle {
namespace {

using Quad = std::array<int, 4>;

/// Level values on the nodes of a lattice around the shape, shape frame.
struct Lattice {
  Index3 nodes;
  Vec3 origin;
  double cell;
  std::vector<double> values;

  std::size_t offset(int i, int j, int k) const {
    return static_cast<std::size_t>(i) +
           static_cast<std::size_t>(nodes[0]) *
               (static_cast<std::size_t>(j) + static_cast<std::size_t>(nodes[1]) * static_cast<std::size_t>(k));
  }
  std::size_t offset(const Index3& n) const { return offset(n[0], n[1], n[2]); }
  Vec3 position(const Index3& n) const { return origin + cell * Vec3(n[0], n[1], n[2]); }
};

Lattice sample_lattice(const Shape& shape, double cell) {
  Lattice lattice;
  lattice.cell = cell;
  const Vec3 half = half_bounds(shape);
  // Off-centre by an odd fraction of a cell, so that symmetric shapes do not pass through nodes.
  lattice.origin = -half - cell * Vec3(2.137, 2.291, 2.419);
  for (std::size_t a = 0; a < 3; ++a) {
    lattice.nodes[a] = static_cast<int>(std::ceil(2.0 * half[static_cast<int>(a)] / cell)) + 6;
  }
  lattice.values.resize(lattice.offset(0, 0, lattice.nodes[2]));
  parallel_for(static_cast<std::size_t>(lattice.nodes[2]), 1, [&](std::size_t begin, std::size_t end) {
    for (int k = static_cast<int>(begin); k < static_cast<int>(end); ++k) {
      for (int j = 0; j < lattice.nodes[1]; ++j) {
        for (int i = 0; i < lattice.nodes[0]; ++i) {
          lattice.values[lattice.offset(i, j, k)] = level(shape, lattice.position({i, j, k})).value;
        }
      }
    }
  });
  return lattice;
}

/// The mean of the crossings on the cell's twelve edges; false when the surface misses the cell.
bool dual_vertex(const Lattice& lattice, const Index3& cell, Vec3& vertex) {
  Vec3 sum = Vec3::Zero();
  int crossings = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (int corner = 0; corner < 4; ++corner) {
      Index3 a = cell;
      a[(axis + 1) % 3] += corner & 1;
      a[(axis + 2) % 3] += corner >> 1;
      Index3 b = a;
      ++b[axis];
      const double va = lattice.values[lattice.offset(a)], vb = lattice.values[lattice.offset(b)];
      if ((va < 0.0) == (vb < 0.0)) continue;
      sum += lattice.position(a) + va / (va - vb) * (lattice.position(b) - lattice.position(a));
      ++crossings;
    }
  }
  if (crossings == 0) return false;
  vertex = sum / crossings;
  return true;
}

struct QuadNet {
  std::vector<Vec3> vertices;
  std::vector<Quad> quads;  ///< counter-clockwise from outside
};

QuadNet surface_net(const Lattice& lattice) {
  QuadNet net;
  std::vector<int> vertex_of_cell(lattice.values.size(), -1);
  const auto for_each_node = [&lattice](int first, const auto& body) {
    for (int k = first; k + 1 < lattice.nodes[2]; ++k) {
      for (int j = first; j + 1 < lattice.nodes[1]; ++j) {
        for (int i = first; i + 1 < lattice.nodes[0]; ++i) body(Index3{i, j, k});
      }
    }
  };
  for_each_node(0, [&](const Index3& n) {
    Vec3 vertex;
    if (!dual_vertex(lattice, n, vertex)) return;
    vertex_of_cell[lattice.offset(n)] = static_cast<int>(net.vertices.size());
    net.vertices.push_back(vertex);
  });
  for_each_node(1, [&](const Index3& n) {
    const bool inside = lattice.values[lattice.offset(n)] < 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Index3 next = n;
      ++next[axis];
      if (inside == (lattice.values[lattice.offset(next)] < 0.0)) continue;
      const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
      Index3 cells[4] = {n, n, n, n};  // around the edge, counter-clockwise seen from its far end
      --cells[0][u], --cells[0][v];
      --cells[1][v];
      --cells[3][u];
      Quad quad{};
      for (std::size_t c = 0; c < 4; ++c) quad[c] = vertex_of_cell[lattice.offset(cells[c])];
      if (!inside) std::swap(quad[1], quad[3]);
      net.quads.push_back(quad);
    }
  });
  return net;
}

Vec3 project(const Shape& shape, Vec3 x) {
  for (int k = 0; k < 30; ++k) {
    const LevelSample s = level(shape, x);
    const Vec3 step = s.value / s.gradient.squaredNorm() * s.gradient;
    x -= step;
    if (step.norm() <= 1e-14 * x.norm()) break;
  }
  return x;
}

void project_all(const Shape& shape, std::vector<Vec3>& vertices) {
  parallel_for(vertices.size(), 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) vertices[v] = project(shape, vertices[v]);
  });
}

/// One step of evening out: each vertex goes to the centre of the polygons around it (weighted by their number of
/// corners), then back onto the surface.
template <class Polygon>
void relax(const Shape& shape, const std::vector<Polygon>& polygons, std::vector<Vec3>& vertices) {
  std::vector<Vec3> sums(vertices.size(), Vec3::Zero());
  std::vector<int> counts(vertices.size(), 0);
  for (const Polygon& polygon : polygons) {
    Vec3 total = Vec3::Zero();
    for (const int v : polygon) total += vertices[static_cast<std::size_t>(v)];
    for (const int v : polygon) {
      sums[static_cast<std::size_t>(v)] += total;
      counts[static_cast<std::size_t>(v)] += static_cast<int>(polygon.size());
    }
  }
  for (std::size_t v = 0; v < vertices.size(); ++v) vertices[v] = sums[v] / counts[v];
  project_all(shape, vertices);
}

std::vector<std::array<int, 3>> split(const QuadNet& net) {
  std::vector<std::array<int, 3>> triangles;
  triangles.reserve(2 * net.quads.size());
  const auto vertex = [&net](int v) -> const Vec3& { return net.vertices[static_cast<std::size_t>(v)]; };
  for (const Quad& q : net.quads) {
    const bool first = (vertex(q[0]) - vertex(q[2])).squaredNorm() <= (vertex(q[1]) - vertex(q[3])).squaredNorm();
    if (first) {
      triangles.push_back({q[0], q[1], q[2]});
      triangles.push_back({q[0], q[2], q[3]});
    } else {
      triangles.push_back({q[0], q[1], q[3]});
      triangles.push_back({q[1], q[2], q[3]});
    }
  }
  return triangles;
}

}  // namespace

TriangleMesh mesh_of(const Body& body, double cell) {
  QuadNet net = surface_net(sample_lattice(body.shape, cell));
  project_all(body.shape, net.vertices);
  constexpr int kSteps = 8;
  for (int step = 0; step < kSteps; ++step) relax(body.shape, net.quads, net.vertices);
  TriangleMesh mesh;
  mesh.triangles = split(net);
  mesh.vertices = std::move(net.vertices);
  for (int step = 0; step < kSteps / 2; ++step) relax(body.shape, mesh.triangles, mesh.vertices);
  mesh.normals.reserve(mesh.vertices.size());
  for (Vec3& x : mesh.vertices) {
    mesh.normals.emplace_back(body.world_from_shape * level(body.shape, x).gradient.normalized());
    x = body.center + body.world_from_shape * x;
  }
  return mesh;
}

}  // namespace pellicle
