#include "pellicle/mesh/quad/quad_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include "pellicle/base/errors.h"

namespace pellicle {
namespace {

using Key = std::pair<int, int>;

[[noreturn]] void fail(const std::string& where, const std::string& why) {
  throw BadData(fmt::format("quad mesh ({}): {}", where, why));
}

std::string edge_name(const Key& edge) {
  return fmt::format("edge {}-{}", edge.first, edge.second);
}

/// A quad at an edge, and whether it runs along it from the lower to the higher vertex.
struct Side {
  int quad;
  bool rising;
};

void check_corners(int vertex_count, const std::vector<Quad>& quads) {
  if (quads.empty()) fail("all", "has no quads");
  for (std::size_t f = 0; f < quads.size(); ++f) {
    for (std::size_t i = 0; i < 4; ++i) {
      const int v = quads[f][i];
      if (v < 0 || v >= vertex_count) {
        fail(fmt::format("quad {}", f), fmt::format("vertex {} is not among the {} there are", v, vertex_count));
      }
      for (std::size_t j = 0; j < i; ++j) {
        if (quads[f][j] == v) fail(fmt::format("quad {}", f), fmt::format("uses vertex {} twice", v));
      }
    }
  }
}

std::map<Key, std::vector<Side>> sides_of(const std::vector<Quad>& quads) {
  std::map<Key, std::vector<Side>> sides;
  for (std::size_t f = 0; f < quads.size(); ++f) {
    for (std::size_t i = 0; i < 4; ++i) {
      const int a = quads[f][i], b = quads[f][(i + 1) % 4];
      sides[std::minmax(a, b)].push_back({static_cast<int>(f), a < b});
    }
  }
  return sides;
}

/// Whether turning some of the quads round would make them agree.
bool orientable(std::size_t quad_count, const std::map<Key, std::vector<Side>>& sides) {
  std::vector<std::vector<std::pair<int, bool>>> next(quad_count);  // neighbour, and whether it must turn against
  for (const auto& [edge, at] : sides) {
    if (at.size() != 2) continue;
    const bool against = at[0].rising == at[1].rising;
    next[static_cast<std::size_t>(at[0].quad)].emplace_back(at[1].quad, against);
    next[static_cast<std::size_t>(at[1].quad)].emplace_back(at[0].quad, against);
  }
  std::vector<int> turned(quad_count, -1);
  for (std::size_t seed = 0; seed < quad_count; ++seed) {
    if (turned[seed] >= 0) continue;
    turned[seed] = 0;
    std::vector<int> stack{static_cast<int>(seed)};
    while (!stack.empty()) {
      const auto f = static_cast<std::size_t>(stack.back());
      stack.pop_back();
      for (const auto& [g, against] : next[f]) {
        const int wanted = turned[f] ^ static_cast<int>(against);
        int& have = turned[static_cast<std::size_t>(g)];
        if (have < 0) {
          have = wanted;
          stack.push_back(g);
        } else if (have != wanted) {
          return false;
        }
      }
    }
  }
  return true;
}

void check_edges(std::size_t quad_count, const std::map<Key, std::vector<Side>>& sides, Border border) {
  for (const auto& [edge, at] : sides) {
    if (at.size() > 2) fail(edge_name(edge), fmt::format("has {} quads; a surface has at most two", at.size()));
  }
  for (const auto& [edge, at] : sides) {
    if (at.size() == 2 && at[0].rising == at[1].rising) {
      const bool helps = orientable(quad_count, sides);
      fail(edge_name(edge),
           fmt::format("quads {} and {} disagree about outside; {}", at[0].quad, at[1].quad,
                       helps ? "turn some of the quads round" : "the surface has only one side (not orientable)"));
    }
    if (at.size() == 1 && border == Border::refused) {
      fail(edge_name(edge), fmt::format("is open, only quad {} has it; the surface must be closed", at[0].quad));
    }
  }
}

/// The corner at which quad `f` has vertex v.
std::size_t corner_of(const Quad& quad, int v) {
  return static_cast<std::size_t>(std::find(quad.begin(), quad.end(), v) - quad.begin());
}

/// Rings by walking from quad to quad round each vertex, from the border where there is one.
std::vector<QuadRing> rings_of(int vertex_count, const std::vector<Quad>& quads) {
  struct Step {
    int edge, quad;
  };
  std::vector<std::vector<Step>> around(static_cast<std::size_t>(vertex_count));
  for (std::size_t f = 0; f < quads.size(); ++f) {
    for (std::size_t i = 0; i < 4; ++i) {
      around[static_cast<std::size_t>(quads[f][i])].push_back({quads[f][(i + 1) % 4], static_cast<int>(f)});
    }
  }
  std::vector<QuadRing> rings(static_cast<std::size_t>(vertex_count));
  for (int v = 0; v < vertex_count; ++v) {
    const std::vector<Step>& steps = around[static_cast<std::size_t>(v)];
    if (steps.empty()) fail(fmt::format("vertex {}", v), "belongs to no quad");
    const auto from = [&](int edge) {
      return std::find_if(steps.begin(), steps.end(), [&](const Step& s) { return s.edge == edge; });
    };
    const auto end_of = [&](const Step& s) {
      const Quad& q = quads[static_cast<std::size_t>(s.quad)];
      return q[(corner_of(q, v) + 3) % 4];
    };
    int first = steps.front().edge;
    for (const Step& s : steps) {  // an edge that no quad ends with lies on the border
      const bool reached = std::any_of(steps.begin(), steps.end(), [&](const Step& t) { return end_of(t) == s.edge; });
      if (!reached) first = s.edge;
    }
    QuadRing& ring = rings[static_cast<std::size_t>(v)];
    int edge = first;
    for (auto at = from(edge); at != steps.end(); at = from(edge)) {
      const Quad& q = quads[static_cast<std::size_t>(at->quad)];
      ring.edge.push_back(edge);
      ring.diagonal.push_back(q[(corner_of(q, v) + 2) % 4]);
      ring.quad.push_back(at->quad);
      edge = end_of(*at);
      if (edge == first) break;
    }
    ring.closed = edge == first;
    if (!ring.closed) ring.edge.push_back(edge);
    if (ring.quad.size() != steps.size()) {
      fail(fmt::format("vertex {}", v), "two sheets touch in it: not a manifold");
    }
    if (ring.closed && ring.valence() < 3) {
      fail(fmt::format("vertex {}", v), "lies between two quads only; merge them");
    }
  }
  return rings;
}

int parts_of(int vertex_count, const std::vector<QuadEdge>& edges, bool borders_only) {
  std::vector<int> parent(static_cast<std::size_t>(vertex_count));
  std::iota(parent.begin(), parent.end(), 0);
  std::vector<bool> used(parent.size(), false);
  const auto find = [&](int i) {
    auto at = static_cast<std::size_t>(i);
    while (parent[at] != static_cast<int>(at)) {
      parent[at] = parent[static_cast<std::size_t>(parent[at])];
      at = static_cast<std::size_t>(parent[at]);
    }
    return static_cast<int>(at);
  };
  for (const QuadEdge& e : edges) {
    if (borders_only && !e.on_border()) continue;
    used[static_cast<std::size_t>(e.a)] = used[static_cast<std::size_t>(e.b)] = true;
    const int a = find(e.a), b = find(e.b);
    parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }
  int count = 0;
  for (int v = 0; v < vertex_count; ++v) count += used[static_cast<std::size_t>(v)] && find(v) == v ? 1 : 0;
  return count;
}

}  // namespace

QuadTopology quad_topology(int vertex_count, const std::vector<Quad>& quads, Border border) {
  check_corners(vertex_count, quads);
  const std::map<Key, std::vector<Side>> sides = sides_of(quads);
  check_edges(quads.size(), sides, border);
  QuadTopology result;
  result.quads = quads;
  result.rings = rings_of(vertex_count, quads);
  std::map<Key, int> number;
  result.edges.reserve(sides.size());
  for (const auto& [edge, at] : sides) {
    number.emplace(edge, static_cast<int>(result.edges.size()));
    result.edges.push_back({edge.first, edge.second, {at[0].quad, at.size() == 2 ? at[1].quad : -1}});
  }
  result.quad_edges.resize(quads.size());
  for (std::size_t f = 0; f < quads.size(); ++f) {
    for (std::size_t i = 0; i < 4; ++i) {
      result.quad_edges[f][i] = number.at(std::minmax(quads[f][i], quads[f][(i + 1) % 4]));
    }
  }
  result.components = parts_of(vertex_count, result.edges, false);
  result.border_loops = parts_of(vertex_count, result.edges, true);
  result.euler = vertex_count - static_cast<int>(result.edges.size()) + static_cast<int>(quads.size());
  result.genus = (2 * result.components - result.border_loops - result.euler) / 2;
  return result;
}

TriangleMesh split_quads(const QuadMesh& mesh, const std::vector<Vec3>& normals) {
  TriangleMesh result{mesh.vertices, {}, normals};
  result.triangles.reserve(2 * mesh.quads.size());
  const auto cost = [&](int a, int b) {
    const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
    return normals.empty() ? (mesh.vertices[i] - mesh.vertices[j]).squaredNorm() : -normals[i].dot(normals[j]);
  };
  for (const auto& [a, b, c, d] : mesh.quads) {
    if (cost(b, d) < cost(a, c)) {
      result.triangles.push_back({a, b, d});
      result.triangles.push_back({b, c, d});
    } else {
      result.triangles.push_back({a, b, c});
      result.triangles.push_back({a, c, d});
    }
  }
  return result;
}

QuadMesh cube_mesh() {
  QuadMesh mesh;
  mesh.vertices.reserve(8);
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 sign(corner & 1, corner >> 1 & 1, corner >> 2);
    mesh.vertices.emplace_back((2 * sign - Vec3::Ones()).normalized());
  }
  mesh.quads = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  return mesh;
}

QuadMesh torus_mesh(int around, int across, double major, double minor) {
  QuadMesh mesh;
  mesh.vertices.reserve(static_cast<std::size_t>(around) * static_cast<std::size_t>(across));
  mesh.quads.reserve(mesh.vertices.capacity());
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const double u = 2 * std::numbers::pi * i / around, v = 2 * std::numbers::pi * j / across;
      const double rho = major + minor * std::cos(v);
      mesh.vertices.emplace_back(rho * std::cos(u), rho * std::sin(u), minor * std::sin(v));
      const auto at = [&](int a, int b) { return a % around * across + b % across; };
      mesh.quads.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

}  // namespace pellicle
