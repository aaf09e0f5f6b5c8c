#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <numeric>

#include "pellicle/base/errors.h"
#include "pellicle/mesh/measure.h"

namespace pellicle {

namespace {

// One side of a facet: the edge it runs along (smaller vertex first), the direction, and where it is.
struct FacetSide {
  std::uint64_t edge;
  std::uint32_t corner;  ///< 3 * facet + corner at which the side starts
  bool forward;          ///< from the smaller to the larger vertex
};

std::vector<FacetSide> sorted_sides(const std::vector<std::array<int, 3>>& triangles) {
  std::vector<FacetSide> sides;
  sides.reserve(3 * triangles.size());
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    for (std::size_t c = 0; c < 3; ++c) {
      const auto a = static_cast<std::uint64_t>(triangles[f][c]);
      const auto b = static_cast<std::uint64_t>(triangles[f][(c + 1) % 3]);
      sides.push_back({std::min(a, b) << 32 | std::max(a, b), static_cast<std::uint32_t>(3 * f + c), a < b});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const FacetSide& x, const FacetSide& y) {
    return x.edge != y.edge ? x.edge < y.edge : x.corner < y.corner;
  });
  return sides;
}

std::string edge_name(std::uint64_t edge) {
  return fmt::format("edge {}-{}", edge >> 32, edge & 0xffffffffU);
}

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0U); }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

std::uint32_t next_corner(std::uint32_t corner) {
  return corner % 3 == 2 ? corner - 2 : corner + 1;
}

class Survey {
 public:
  explicit Survey(const TriangleMesh& mesh)
      : mesh_(mesh), fans_(3 * mesh.triangles.size()), rims_(mesh.vertices.size()), on_rim_(mesh.vertices.size()) {}

  MeshTopology run() {
    topology_.closed = topology_.manifold = topology_.oriented = !mesh_.triangles.empty();
    if (mesh_.triangles.empty()) fault("the mesh has no facets");
    for (std::size_t f = 0; f < mesh_.triangles.size(); ++f) {
      const auto& t = mesh_.triangles[f];
      if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) continue;
      topology_.manifold = false;
      fault(fmt::format("facet {} repeats a vertex", f));
    }
    const std::vector<FacetSide> sides = sorted_sides(mesh_.triangles);
    int edges = 0;
    for (std::size_t i = 0; i < sides.size(); ++edges) {
      std::size_t end = i;
      while (end < sides.size() && sides[end].edge == sides[i].edge) ++end;
      add_edge(sides.data() + i, end - i);
      i = end;
    }
    count(edges);
    return topology_;
  }

 private:
  void fault(const std::string& what) {
    if (topology_.first_fault.empty()) topology_.first_fault = what;
  }

  void add_edge(const FacetSide* side, std::size_t facets) {
    if (facets != 2) {
      topology_.closed = false;
      if (facets > 2) topology_.manifold = false;
      if (facets == 1) add_rim(side[0].edge);
      fault(facets == 1 ? fmt::format("{} is open: it has one facet", edge_name(side[0].edge))
                        : fmt::format("{} has {} facets", edge_name(side[0].edge), facets));
    } else if (side[0].forward == side[1].forward) {
      topology_.oriented = false;
      fault(fmt::format("{} is run through twice in one direction: its facets disagree about outside",
                        edge_name(side[0].edge)));
    }
    if (facets > 2) {
      const auto forward = std::count_if(side, side + facets, [](const FacetSide& s) { return s.forward; });
      if (2 * static_cast<std::size_t>(forward) != facets) topology_.oriented = false;
    }
    for (std::size_t k = 1; k < facets; ++k) {
      const auto ends = [](const FacetSide& s) {
        const std::uint32_t start = s.corner, stop = next_corner(s.corner);
        return s.forward ? std::pair(start, stop) : std::pair(stop, start);
      };
      fans_.unite(ends(side[0]).first, ends(side[k]).first);
      fans_.unite(ends(side[0]).second, ends(side[k]).second);
    }
  }

  void add_rim(std::uint64_t edge) {
    const auto a = static_cast<std::uint32_t>(edge >> 32), b = static_cast<std::uint32_t>(edge & 0xffffffffU);
    on_rim_[a] = on_rim_[b] = true;
    rims_.unite(a, b);
  }

  void count(int edges) {
    DisjointSets parts(mesh_.vertices.size());
    std::vector<int> fans(mesh_.vertices.size());
    for (std::uint32_t corner = 0; corner < 3 * mesh_.triangles.size(); ++corner) {
      const auto& t = mesh_.triangles[corner / 3];
      parts.unite(static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[corner % 3]));
      if (fans_.find(corner) == corner) ++fans[static_cast<std::size_t>(t[corner % 3])];
    }
    int used = 0;
    for (std::size_t v = 0; v < fans.size(); ++v) {
      if (fans[v] == 0) continue;
      ++used;
      if (parts.find(static_cast<std::uint32_t>(v)) == v) ++topology_.components;
      if (fans[v] == 1) continue;
      topology_.manifold = false;
      fault(fmt::format("vertex {} joins {} separate fans", v, fans[v]));
    }
    topology_.euler = used - edges + static_cast<int>(mesh_.triangles.size());
    if (!topology_.manifold || !topology_.oriented) return;
    for (std::size_t v = 0; v < on_rim_.size(); ++v) {
      if (on_rim_[v] && rims_.find(static_cast<std::uint32_t>(v)) == v) ++topology_.border_loops;
    }
    topology_.genus = (2 * topology_.components - topology_.border_loops - topology_.euler) / 2;
  }

  const TriangleMesh& mesh_;
  DisjointSets fans_;  ///< of corners: those around one vertex that are linked by edges
  DisjointSets rims_;  ///< of vertices: those that are linked by open edges
  std::vector<bool> on_rim_;
  MeshTopology topology_;
};

}  // namespace

MeshTopology topology_of(const TriangleMesh& mesh) {
  check_indices(mesh);
  return Survey(mesh).run();
}

void require_closed(const TriangleMesh& mesh, const std::string& what) {
  check_indices(mesh);
  if (mesh.triangles.empty()) throw BadData(fmt::format("{} (surface): it has no facets", what));
  const std::vector<FacetSide> sides = sorted_sides(mesh.triangles);
  for (std::size_t i = 0; i < sides.size();) {
    long balance = 0;
    std::size_t end = i;
    for (; end < sides.size() && sides[end].edge == sides[i].edge; ++end) balance += sides[end].forward ? 1 : -1;
    // A facet that repeats a vertex has a side without length; it bounds nothing.
    const bool point = sides[i].edge >> 32 == (sides[i].edge & 0xffffffffU);
    if (balance != 0 && !point) {
      const std::string why = end - i == 1 ? "is open" : "is not run through equally often both ways";
      throw BadData(fmt::format("{} (surface): {} {}; the surface must be closed and consistently oriented", what,
                                edge_name(sides[i].edge), why));
    }
    i = end;
  }
}

std::vector<std::vector<int>> border_loops(const std::vector<std::array<int, 3>>& triangles) {
  const std::vector<FacetSide> sides = sorted_sides(triangles);
  std::map<int, int> after;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const bool alone =
        (i == 0 || sides[i - 1].edge != sides[i].edge) && (i + 1 == sides.size() || sides[i + 1].edge != sides[i].edge);
    if (!alone) continue;
    const auto& t = triangles[sides[i].corner / 3];
    after[t[sides[i].corner % 3]] = t[(sides[i].corner + 1) % 3];
  }
  std::vector<std::vector<int>> loops;
  while (!after.empty()) {
    std::vector<int>& loop = loops.emplace_back();
    for (auto at = after.begin(); at != after.end();) {
      const int next = at->second;
      loop.push_back(at->first);
      after.erase(at);
      at = after.find(next);
    }
  }
  return loops;
}

}  // namespace pellicle
