#include "pellicle/surface/quad/catmull_clark_model.h"

#include <algorithm>
#include <cmath>

#include "pellicle/mesh/quad/quad_subdivision.h"
#include "pellicle/surface/internal/control_fit.h"
#include "pellicle/surface/internal/gauss_legendre.h"
#include "pellicle/surface/quad/internal/catmull_clark_limits.h"

namespace pellicle {
namespace {

constexpr int kLeastIsolation = 6;
constexpr int kSphereLevel = 2;  ///< density at which the sphere is fitted

/// Samples owned by each quad: those that no earlier quad has.
struct Owned {
  std::vector<QuadPlace> places;
  std::vector<int> nodes;
  std::vector<std::size_t> start{0};  ///< of each quad
};

Owned owned_by_quads(const QuadTopology& topology, const QuadGrid& grid) {
  Owned owned;
  const int n = grid.intervals();
  std::vector<bool> taken(static_cast<std::size_t>(grid.node_count()), false);
  owned.nodes.reserve(taken.size());
  owned.places.reserve(taken.size());
  for (int f = 0; f < static_cast<int>(topology.quads.size()); ++f) {
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n; ++i) {
        const int node = grid.node(f, i, j);
        if (taken[static_cast<std::size_t>(node)]) continue;
        taken[static_cast<std::size_t>(node)] = true;
        owned.nodes.push_back(node);
        owned.places.push_back({f, static_cast<double>(i) / n, static_cast<double>(j) / n});
      }
    }
    owned.start.push_back(owned.nodes.size());
  }
  return owned;
}

/// Masks instead of OpenSubdiv's weights, whose derivatives at an extraordinary vertex have a length that depends on
/// the isolation (and whose caps on a border are approximations). Tangents on a border are OpenSubdiv's.
SampleWeights weights_at_vertex(const LimitMasks& masks, int vertex, const SampleWeights& limit) {
  SampleWeights result;
  const auto row = static_cast<std::size_t>(vertex);
  const auto append = [&](const PointRows& rows, double x, double u, double v) {
    for (auto k = static_cast<std::size_t>(rows.start[row]); k < static_cast<std::size_t>(rows.start[row + 1]); ++k) {
      result.add(rows.index[k], x * rows.weight[k], u * rows.weight[k], v * rows.weight[k]);
    }
  };
  append(masks.position, 1, 0, 0);
  if (masks.tangent_u.start[row] == masks.tangent_u.start[row + 1]) {
    for (std::size_t k = 0; k < limit.index.size(); ++k) result.add(limit.index[k], 0, limit.u[k], limit.v[k]);
  }
  append(masks.tangent_u, 0, 1, 0);
  append(masks.tangent_v, 0, 0, 1);
  return result;
}

SampleWeights weights_at_place(const LimitWeights& limits, std::size_t row) {
  SampleWeights result;
  for (auto k = static_cast<std::size_t>(limits.start[row]); k < static_cast<std::size_t>(limits.start[row + 1]); ++k) {
    result.add(limits.index[k], limits.x[k], limits.s[k], limits.t[k]);
  }
  return result;
}

}  // namespace

CatmullClarkModel::CatmullClarkModel(int vertex_count, const std::vector<Quad>& quads, QuadReference reference,
                                     Border border)
    : control_(quad_control(vertex_count, quads, std::move(reference), border)) {}

CatmullClarkModel CatmullClarkModel::start(int refinements) {
  const QuadMesh cube = cube_mesh();
  const CatmullClarkModel bare(8, cube.quads, {});
  CatmullClarkModel model(8, cube.quads,
                          {fit_unit_sphere(bare.layout(kSphereLevel), parameters_of(cube.vertices)), true});
  for (int i = 0; i < refinements; ++i) model = model.refine(model.reference()).first;
  return model;
}

std::vector<BlockKind> CatmullClarkModel::blocks() const {
  return std::vector<BlockKind>(static_cast<std::size_t>(vertex_count()), BlockKind::point);
}

TriangleMesh CatmullClarkModel::control_mesh(const Parameters& parameters) const {
  return split_quads({points_of(parameters), topology().quads});
}

SampleLayout CatmullClarkModel::layout(int level) const {
  const QuadGrid grid(topology(), level);
  const Owned owned = owned_by_quads(topology(), grid);
  // A sample beside an extraordinary vertex is 2^-level away from it: separated after `level` steps.
  const CatmullClarkLimits limits(topology(), std::max(kLeastIsolation, level + 1), LimitCap::gregory);
  const LimitWeights weights = limits.at(owned.places);
  const LimitMasks masks = catmull_clark_limit(topology());
  SampleLayout layout;
  LinearStencils stencils;
  std::vector<int> sample_of_node(owned.nodes.size());
  for (std::size_t f = 0; f + 1 < owned.start.size(); ++f) {
    std::vector<SampleWeights> samples;
    samples.reserve(owned.start[f + 1] - owned.start[f]);
    for (std::size_t k = owned.start[f]; k < owned.start[f + 1]; ++k) {
      const int node = owned.nodes[k];
      sample_of_node[static_cast<std::size_t>(node)] = static_cast<int>(k);
      const SampleWeights limit = weights_at_place(weights, k);
      samples.push_back(node < vertex_count() ? weights_at_vertex(masks, node, limit) : limit);
    }
    add_patch(layout, stencils, samples);
  }
  finish_layout(layout, std::move(stencils), grid, level, sample_of_node, control_->reference);
  return layout;
}

void CatmullClarkModel::evaluate(const Parameters& parameters, const SampleLayout& layout, bool with_jacobian,
                                 SurfaceSamples& samples) const {
  evaluate_linear(parameters, layout, with_jacobian, samples);
}

void CatmullClarkModel::pull_back(const Parameters& /*parameters*/, const SampleLayout& layout,
                                  const std::vector<Vec3>& dE_dx, std::vector<double>& gradient) const {
  pull_back_linear(layout, dE_dx, gradient);
}

PointRows CatmullClarkModel::limit_rows() const {
  return catmull_clark_limit(topology()).position;
}

std::pair<CatmullClarkModel, Parameters> CatmullClarkModel::refine(const Parameters& parameters) const {
  const QuadStep step = catmull_clark_step(topology());
  QuadReference refined = reference_shape();
  if (!refined.points.empty()) refined.points = parameters_of(step.rows.apply(points_of(refined.points)));
  const int count = static_cast<int>(step.rows.size());
  const Border border = is_closed() ? Border::refused : Border::allowed;
  if (refined.sphere) {
    const CatmullClarkModel bare(count, step.quads, {}, border);
    refined.points = fit_unit_sphere(bare.layout(kSphereLevel), refined.points);
  }
  return {CatmullClarkModel(count, step.quads, std::move(refined), border),
          parameters_of(step.rows.apply(points_of(parameters)))};
}

PointRows thin_plate_rows(const CatmullClarkModel& model, double membrane, double bending) {
  constexpr int kIsolation = 3;
  const Quadrature gauss = gauss_legendre(4);  // exact for the squares of bicubics' derivatives
  const CatmullClarkLimits limits(model.topology(), kIsolation, LimitCap::bspline);
  std::vector<QuadPlace> places;
  std::vector<double> area;
  const std::vector<QuadPiece> pieces = limits.pieces();
  places.reserve(16 * pieces.size());
  area.reserve(16 * pieces.size());
  for (const QuadPiece& piece : pieces) {
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = 0; j < 4; ++j) {
        places.push_back({piece.quad, piece.s + piece.width * gauss.at[i], piece.t + piece.width * gauss.at[j]});
        area.push_back(gauss.weight[i] * gauss.weight[j] * piece.width * piece.width);
      }
    }
  }
  const LimitWeights weights = limits.at(places, true);
  PointRows rows;
  for (std::size_t r = 0; r < places.size(); ++r) {
    const auto append = [&](const std::vector<double>& derivative, double weight) {
      if (!(weight > 0)) return;
      for (auto k = static_cast<std::size_t>(weights.start[r]); k < static_cast<std::size_t>(weights.start[r + 1]);
           ++k) {
        rows.add(weights.index[k], std::sqrt(weight * area[r]) * derivative[k]);
      }
      rows.close();
    };
    append(weights.s, membrane);
    append(weights.t, membrane);
    append(weights.ss, bending);
    append(weights.st, 2 * bending);
    append(weights.tt, bending);
  }
  return rows;
}

}  // namespace pellicle
