#include "pellicle/surface/quad/quad_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "pellicle/base/errors.h"

namespace pellicle {

std::shared_ptr<const QuadControl> quad_control(int vertex_count, const std::vector<Quad>& quads,
                                                QuadReference reference, Border border) {
  QuadTopology topology = quad_topology(vertex_count, quads, border);
  if (!reference.points.empty() && reference.points.size() != 3 * static_cast<std::size_t>(vertex_count)) {
    throw BadData(fmt::format("reference shape of the control mesh (all): {} numbers where 3 a vertex, {}, belong",
                              reference.points.size(), 3 * vertex_count));
  }
  for (std::size_t i = 0; i < reference.points.size(); ++i) {
    if (!std::isfinite(reference.points[i])) {
      throw BadData(fmt::format("reference shape of the control mesh (vertex {}): is not finite", i / 3));
    }
  }
  return std::make_shared<const QuadControl>(QuadControl{std::move(topology), std::move(reference)});
}

QuadGrid::QuadGrid(const QuadTopology& topology, int level) : topology_(topology) {
  if (level < 0 || level > highest_level) {
    throw UsageError(fmt::format("surface density ({}): must be a level from 0 to {}", level, highest_level));
  }
  intervals_ = 1 << level;
}

int QuadGrid::node_count() const {
  const int inner = intervals_ - 1;
  return topology_.vertex_count() + inner * static_cast<int>(topology_.edges.size()) +
         inner * inner * static_cast<int>(topology_.quads.size());
}

int QuadGrid::node(int quad, int i, int j) const {
  const auto f = static_cast<std::size_t>(quad);
  const int n = intervals_, inner = n - 1;
  const bool side_i = i == 0 || i == n, side_j = j == 0 || j == n;
  if (side_i && side_j) {
    const int corner = j == 0 ? i / n : 3 - i / n;
    return topology_.quads[f][static_cast<std::size_t>(corner)];
  }
  if (side_i || side_j) {
    // along the side from its first corner on: 0 -> 1, 1 -> 2, 2 -> 3, 3 -> 0
    const std::size_t side = j == 0 ? 0 : i == n ? 1 : j == n ? 2 : 3;
    const std::array<int, 4> along{i, j, n - i, n - j};
    const int edge = topology_.quad_edges[f][side];
    const bool rising = topology_.edges[static_cast<std::size_t>(edge)].a == topology_.quads[f][side];
    const int place = rising ? along[side] : n - along[side];
    return topology_.vertex_count() + inner * edge + place - 1;
  }
  return topology_.vertex_count() + inner * static_cast<int>(topology_.edges.size()) + inner * inner * quad +
         inner * (j - 1) + i - 1;
}

int QuadGrid::node_from_corner(int quad, int corner, int i, int j) const {
  const int n = intervals_;
  switch (corner) {
    case 0:
      return node(quad, i, j);
    case 1:
      return node(quad, n - j, i);
    case 2:
      return node(quad, n - i, n - j);
    default:
      return node(quad, j, n - i);
  }
}

std::vector<std::array<int, 3>> QuadGrid::triangles(const std::vector<int>& sample_of_node) const {
  std::vector<std::array<int, 3>> result;
  const auto n = static_cast<std::size_t>(intervals_);
  result.reserve(2 * n * n * topology_.quads.size());
  for (int f = 0; f < static_cast<int>(topology_.quads.size()); ++f) {
    const auto at = [&](int i, int j) { return sample_of_node[static_cast<std::size_t>(node(f, i, j))]; };
    for (int j = 0; j < intervals_; ++j) {
      for (int i = 0; i < intervals_; ++i) {
        result.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
        result.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
      }
    }
  }
  return result;
}

void add_patch(SampleLayout& layout, LinearStencils& stencils, const std::vector<SampleWeights>& samples) {
  std::vector<int> blocks;
  for (const SampleWeights& s : samples) blocks.insert(blocks.end(), s.index.begin(), s.index.end());
  std::sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  begin_patch(layout, blocks);
  std::vector<double> x, u, v;
  for (const SampleWeights& s : samples) {
    for (std::vector<double>* w : {&x, &u, &v}) w->assign(blocks.size(), 0.0);
    for (std::size_t k = 0; k < s.index.size(); ++k) {
      const auto at =
          static_cast<std::size_t>(std::lower_bound(blocks.begin(), blocks.end(), s.index[k]) - blocks.begin());
      x[at] += s.x[k];
      u[at] += s.u[k];
      v[at] += s.v[k];
    }
    add_sample(layout, stencils, x, u, v);
  }
}

void finish_layout(SampleLayout& layout, LinearStencils stencils, const QuadGrid& grid, int level,
                   const std::vector<int>& sample_of_node, const QuadReference& reference) {
  layout.level = level;
  layout.triangles = grid.triangles(sample_of_node);
  layout.stencils = std::make_shared<const LinearStencils>(std::move(stencils));
  if (reference.points.empty()) return;
  SurfaceSamples samples;
  evaluate_linear(reference.points, layout, false, samples);
  layout.reference = std::move(samples.x);
  if (!reference.sphere) return;
  for (Vec3& x : layout.reference) x.normalize();
}

int refinements_of(const QuadTopology& topology) {
  int count = 0;
  for (std::size_t quads = topology.quads.size(); quads >= 24; quads /= 4) ++count;
  return count;
}

std::vector<Vec3> points_of(const Parameters& parameters) {
  std::vector<Vec3> points(parameters.size() / 3);
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = Vec3(parameters.data() + 3 * i);
  return points;
}

Parameters parameters_of(const std::vector<Vec3>& points) {
  Parameters parameters(3 * points.size());
  for (std::size_t i = 0; i < points.size(); ++i) std::copy_n(points[i].data(), 3, parameters.data() + 3 * i);
  return parameters;
}

}  // namespace pellicle
