#include "pellicle/surface/normal/normal_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "pellicle/base/errors.h"
#include "pellicle/surface/normal/internal/triangle_refinement.h"

namespace pellicle {
namespace {

using Triangles = std::vector<std::array<int, 3>>;
using DirectedEdge = std::pair<int, int>;

constexpr int kHighestLevel = 7;

[[noreturn]] void fail(const std::string& where, const std::string& why) {
  throw BadData(fmt::format("control mesh ({}): {}", where, why));
}

/// The triangle on the left of each directed edge.
std::map<DirectedEdge, int> edges_of(const Triangles& triangles, int vertex_count) {
  std::map<DirectedEdge, int> left;
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    for (int i = 0; i < 3; ++i) {
      const int a = triangles[f][i], b = triangles[f][(i + 1) % 3];
      if (a < 0 || a >= vertex_count) {
        fail(fmt::format("triangle {}", f), fmt::format("vertex {} is not among the {} points", a, vertex_count));
      }
      if (a == b) fail(fmt::format("triangle {}", f), fmt::format("uses vertex {} twice", a));
      if (!left.emplace(DirectedEdge{a, b}, static_cast<int>(f)).second) {
        fail(fmt::format("edge {}-{}", a, b),
             "two triangles run along it in the same direction: not an oriented manifold");
      }
    }
  }
  for (const auto& [edge, f] : left) {
    if (!left.contains({edge.second, edge.first})) {
      fail(fmt::format("edge {}-{}", edge.first, edge.second), fmt::format("open, only triangle {} has it", f));
    }
  }
  return left;
}

/// Every vertex has one closed fan of triangles.
void check_fans(const Triangles& triangles, const std::map<DirectedEdge, int>& left, int vertex_count) {
  std::vector<int> corners(vertex_count, 0), first(vertex_count, -1);
  for (const auto& triangle : triangles) {
    for (int i = 0; i < 3; ++i) {
      ++corners[triangle[i]];
      first[triangle[i]] = triangle[(i + 1) % 3];
    }
  }
  for (int v = 0; v < vertex_count; ++v) {
    if (corners[v] == 0) fail(fmt::format("vertex {}", v), "belongs to no triangle");
    int fan = 0, neighbour = first[v];
    do {
      const auto& triangle = triangles[left.at({v, neighbour})];
      const auto at = std::find(triangle.begin(), triangle.end(), v) - triangle.begin();
      neighbour = triangle[(at + 2) % 3];
      ++fan;
    } while (neighbour != first[v]);
    if (fan != corners[v]) fail(fmt::format("vertex {}", v), "two sheets touch in it: not a manifold");
  }
}

void check_reference(const Parameters& reference, int vertex_count) {
  if (reference.empty()) return;
  if (reference.size() != 6 * std::size_t(vertex_count)) {
    throw BadData(fmt::format("reference shape of the control mesh (all): {} numbers where 6 a vertex, {}, belong",
                              reference.size(), 6 * vertex_count));
  }
  for (int v = 0; v < vertex_count; ++v) {
    const double* const block = reference.data() + 6 * std::size_t(v);
    const Vec3 p(block), n(block + 3);
    if (!p.allFinite() || !(std::abs(n.norm() - 1) <= 1e-6)) {
      throw BadData(fmt::format(
          "reference shape of the control mesh (vertex {}): the point must be finite and the normal have length 1", v));
    }
  }
}

std::vector<Vec3> directions_of(StartSolid solid) {
  if (solid == StartSolid::tetrahedron) return {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  if (solid == StartSolid::octahedron) return {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  const double g = (1 + std::sqrt(5.0)) / 2;
  std::vector<Vec3> result;
  for (const double s : {-1.0, 1.0}) {
    for (const double t : {-g, g}) {
      result.emplace_back(0, s, t);
      result.emplace_back(s, t, 0);
      result.emplace_back(t, 0, s);
    }
  }
  return result;
}

/// Triangles of mutually nearest vertices, counter-clockwise seen from outside: the facets of a deltahedron.
Triangles facets_of(const std::vector<Vec3>& points) {
  const int n = static_cast<int>(points.size());
  double edge = (points[0] - points[1]).norm();
  for (int a = 0; a < n; ++a) {
    for (int b = 0; b < a; ++b) edge = std::min(edge, (points[a] - points[b]).norm());
  }
  const auto joined = [&](int a, int b) { return (points[a] - points[b]).norm() < 1.01 * edge; };
  Triangles result;
  for (int a = 0; a < n; ++a) {
    for (int b = a + 1; b < n; ++b) {
      for (int c = b + 1; c < n; ++c) {
        if (!joined(a, b) || !joined(b, c) || !joined(c, a)) continue;
        const bool outward = points[a].dot(points[b].cross(points[c])) > 0;
        result.push_back(outward ? std::array{a, b, c} : std::array{a, c, b});
      }
    }
  }
  return result;
}

/// Owners of what belongs to several patches, and the samples on it.
struct SharedSamples {
  std::vector<int> at_vertex;                            ///< sample of each control vertex, -1 while unknown
  std::map<DirectedEdge, std::vector<int>> inside_edge;  ///< from the lower to the higher control vertex
};

/// Where the vertex lies on its control edge, counted from the lower control vertex.
int place_on_edge(const TriangleRefinement& refinement, int local, int edge, bool rising) {
  return refinement.barycentric[local][rising ? (edge + 1) % 3 : edge] - 1;
}

/// Appends the patch of `triangle` with its samples; shared ones go to the first patch that claims a vertex, and to the
/// one in which an edge runs from its lower to its higher vertex.
void add_patch(const std::array<int, 3>& triangle, const TriangleRefinement& refinement, SampleLayout& layout,
               SharedSamples& shared) {
  const int index = static_cast<int>(layout.patches.size());
  SamplePatch patch;
  for (const int v : triangle) {
    patch.blocks.push_back(2 * v);
    patch.blocks.push_back(2 * v + 1);
  }
  patch.first_sample = layout.sample_count();
  patch.jacobian_offset = std::size_t(patch.first_sample) * 3 * 18;
  for (int local = 0; local < refinement.vertex_count(); ++local) {
    const int sample = layout.sample_count(), edge = refinement.control_edge(local);
    if (local < 3) {
      if (shared.at_vertex[triangle[local]] >= 0) continue;
      shared.at_vertex[triangle[local]] = sample;
    } else if (edge >= 0) {
      const int a = triangle[edge], b = triangle[(edge + 1) % 3];
      if (a > b) continue;
      std::vector<int>& inside = shared.inside_edge[{a, b}];
      inside.resize((std::size_t(1) << refinement.level) - 1);
      inside[place_on_edge(refinement, local, edge, true)] = sample;
    }
    layout.patch_of.push_back(index);
    layout.owned_local.push_back(local);
  }
  patch.sample_count = layout.sample_count() - patch.first_sample;
  layout.patches.push_back(std::move(patch));
}

/// The sample at each local vertex of a patch.
std::vector<int> samples_of_patch(const std::array<int, 3>& triangle, const TriangleRefinement& refinement,
                                  const SampleLayout& layout, const SamplePatch& patch, const SharedSamples& shared) {
  std::vector<int> result(refinement.vertex_count());
  for (int local = 0; local < refinement.vertex_count(); ++local) {
    const int edge = refinement.control_edge(local);
    if (local < 3) result[local] = shared.at_vertex[triangle[local]];
    if (edge < 0) continue;
    const int a = triangle[edge], b = triangle[(edge + 1) % 3];
    result[local] = shared.inside_edge.at(std::minmax(a, b))[place_on_edge(refinement, local, edge, a < b)];
  }
  for (int i = patch.first_sample; i < patch.first_sample + patch.sample_count; ++i) result[layout.owned_local[i]] = i;
  return result;
}

}  // namespace

NormalModel::NormalModel(int vertex_count, std::vector<std::array<int, 3>> triangles, SubdivisionRule rule,
                         Parameters reference)
    : vertex_count_(vertex_count), triangles_(std::move(triangles)), rule_(rule), reference_(std::move(reference)) {
  if (triangles_.empty()) fail("all", "has no triangles");
  check_fans(triangles_, edges_of(triangles_, vertex_count_), vertex_count_);
  check_reference(reference_, vertex_count_);
}

NormalModel NormalModel::start(StartSolid solid, SubdivisionRule rule) {
  std::vector<Vec3> points = directions_of(solid);
  Parameters reference;
  for (const Vec3& point : points) {
    const Vec3 unit = point.normalized();
    for (int copy = 0; copy < 2; ++copy) reference.insert(reference.end(), unit.begin(), unit.end());
  }
  return {static_cast<int>(points.size()), facets_of(points), rule, std::move(reference)};
}

std::vector<BlockKind> NormalModel::blocks() const {
  std::vector<BlockKind> result;
  for (int v = 0; v < vertex_count_; ++v) {
    result.push_back(BlockKind::point);
    result.push_back(BlockKind::unit_normal);
  }
  return result;
}

int NormalModel::refinements() const {
  int triangles = base_facets(), count = 0;
  while (triangles > 20) {
    triangles /= 4;
    ++count;
  }
  return triangles == 16 ? count + 1 : count;  // a split tetrahedron, where no solid has 16
}

SampleLayout NormalModel::layout(int level) const {
  if (level < 0 || level > kHighestLevel) {
    throw UsageError(fmt::format("surface density ({}): must be a level from 0 to {}", level, kHighestLevel));
  }
  SampleLayout layout;
  layout.level = level;
  layout.refinement = std::make_shared<const TriangleRefinement>(refine_triangle(level));
  SharedSamples shared;
  shared.at_vertex.assign(vertex_count_, -1);
  for (const auto& triangle : triangles_) add_patch(triangle, *layout.refinement, layout, shared);
  for (std::size_t f = 0; f < triangles_.size(); ++f) {
    const auto global = samples_of_patch(triangles_[f], *layout.refinement, layout, layout.patches[f], shared);
    for (const auto& t : layout.refinement->triangles)
      layout.triangles.push_back({global[t[0]], global[t[1]], global[t[2]]});
  }
  if (!reference_.empty()) {
    SurfaceSamples samples;
    evaluate(reference_, layout, false, samples);
    layout.reference = std::move(samples.x);
  }
  return layout;
}

TriangleMesh NormalModel::control_mesh(const Parameters& parameters) const {
  TriangleMesh mesh;
  mesh.triangles = triangles_;
  for (int v = 0; v < vertex_count_; ++v) {
    mesh.vertices.emplace_back(&parameters[6 * std::size_t(v)]);
    mesh.normals.emplace_back(&parameters[6 * std::size_t(v) + 3]);
  }
  return mesh;
}

std::pair<NormalModel, Parameters> NormalModel::refine(const Parameters& parameters) const {
  const SampleLayout once = layout(1);
  SurfaceSamples samples, reference;
  evaluate(parameters, once, false, samples);
  if (!reference_.empty()) evaluate(reference_, once, false, reference);
  std::vector<int> vertex_of(once.patch_of.size());  // old vertices keep their numbers, new ones follow
  int count = vertex_count_;
  for (std::size_t i = 0; i < vertex_of.size(); ++i) {
    const int local = once.owned_local[i];
    vertex_of[i] = local < 3 ? triangles_[once.patch_of[i]][local] : count++;
  }
  Parameters refined(parameters), refined_reference(reference_);
  refined.resize(6 * std::size_t(count));
  if (!reference_.empty()) refined_reference.resize(refined.size());
  for (std::size_t i = 0; i < vertex_of.size(); ++i) {
    const int v = vertex_of[i];
    if (v < vertex_count_) continue;
    std::copy_n(samples.x[i].data(), 3, &refined[6 * std::size_t(v)]);
    std::copy_n(samples.normal[i].data(), 3, &refined[6 * std::size_t(v) + 3]);
    if (reference_.empty()) continue;
    std::copy_n(reference.x[i].data(), 3, &refined_reference[6 * std::size_t(v)]);
    std::copy_n(reference.normal[i].data(), 3, &refined_reference[6 * std::size_t(v) + 3]);
  }
  Triangles triangles;
  for (const auto& t : once.triangles) triangles.push_back({vertex_of[t[0]], vertex_of[t[1]], vertex_of[t[2]]});
  return {NormalModel(count, std::move(triangles), rule_, std::move(refined_reference)), std::move(refined)};
}

void NormalModel::place_on(const SampleLayout& layout, const SampleTargets& targets, Parameters& parameters) const {
  for (int v = 0; v < vertex_count_; ++v) {
    const auto at = 6 * static_cast<std::size_t>(v);
    const Vec3 place(reference_[at], reference_[at + 1], reference_[at + 2]);
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < layout.reference.size(); ++i) {
      if ((layout.reference[i] - place).squaredNorm() < (layout.reference[nearest] - place).squaredNorm()) nearest = i;
    }
    const double length = targets.area[nearest].norm();
    for (int c = 0; c < 3; ++c) {
      parameters[at + static_cast<std::size_t>(c)] = targets.x[nearest][c];
      if (length > 0.0) parameters[at + 3 + static_cast<std::size_t>(c)] = targets.area[nearest][c] / length;
    }
  }
}

}  // namespace pellicle
