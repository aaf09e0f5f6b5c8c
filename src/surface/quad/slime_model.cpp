#include "pellicle/surface/quad/slime_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pellicle/base/errors.h"
#include "pellicle/surface/internal/control_fit.h"

namespace pellicle {
namespace {

constexpr int kFitLevel = 2;  ///< density at which control points are fitted

std::map<int, SlimeBasis> bases_for(const QuadTopology& topology) {
  std::map<int, SlimeBasis> bases;
  for (int v = 0; v < topology.vertex_count(); ++v) {
    const int n = topology.rings[static_cast<std::size_t>(v)].valence();
    if (n > SlimeBasis::highest_valence) {
      throw BadData(fmt::format("quad mesh (vertex {}): {} edges meet there; a slime patch has at most {}", v, n,
                                SlimeBasis::highest_valence));
    }
    if (!bases.contains(n)) bases.emplace(n, SlimeBasis(n));
  }
  return bases;
}

/// Calls add(vertex, weight) for the weights over the Sabin net about v, passed on to the control points.
template <class Weight, class Add>
void spread(const QuadRing& ring, int v, const Weight& weight, const Add& add) {
  const int n = ring.valence();
  double at_vertex = weight(0);
  for (int i = 0; i < n; ++i) at_vertex += 0.5 * weight(1 + i) + 0.25 * weight(1 + n + i);
  add(v, at_vertex);
  for (int i = 0; i < n; ++i) {
    const double centre = 0.25 * weight(1 + n + i);
    add(ring.edge[static_cast<std::size_t>(i)], 0.5 * weight(1 + i) + centre);
    add(ring.diagonal[static_cast<std::size_t>(i)], centre);
    add(ring.edge[static_cast<std::size_t>((i + 1) % n)], centre);
  }
}

/// Domain points of the sector about corner 0, between the middles of the sides at it: (i, j) / half from the centre,
/// i towards e_0 and j towards e_1; row-major, i fastest.
std::vector<Eigen::Vector2d> sector_points(const SlimeBasis& basis, int half) {
  const Eigen::Vector2d corner = basis.corner(0), before = (basis.corner(-1) + corner) / 2,
                        after = (corner + basis.corner(1)) / 2;
  std::vector<Eigen::Vector2d> points;
  points.reserve(static_cast<std::size_t>((half + 1) * (half + 1)));
  for (int j = 0; j <= half; ++j) {
    for (int i = 0; i <= half; ++i) {
      const double s = half > 0 ? static_cast<double>(i) / half : 0, t = half > 0 ? static_cast<double>(j) / half : 0;
      points.emplace_back(s * (1 - t) * before + s * t * corner + (1 - s) * t * after);
    }
  }
  return points;
}

/// The weights of `row` in sector `turns`: the polygon is turned, so the net's numbers are.
SampleWeights sample_weights(const QuadRing& ring, int v, const SlimeWeights& w, Eigen::Index row, int turns) {
  const int n = ring.valence();
  const auto turned = [&](const Eigen::MatrixXd& m) {
    return [&m, row, turns, n](int point) {
      if (point == 0) return m(row, 0);
      const int first = point <= n ? 1 : 1 + n;
      return m(row, first + (point - first - turns + n) % n);
    };
  };
  SampleWeights result;
  spread(ring, v, turned(w.x), [&](int i, double weight) { result.add(i, weight, 0, 0); });
  spread(ring, v, turned(w.u), [&](int i, double weight) { result.add(i, 0, weight, 0); });
  spread(ring, v, turned(w.v), [&](int i, double weight) { result.add(i, 0, 0, weight); });
  return result;
}

std::size_t corner_of(const Quad& quad, int v) {
  return static_cast<std::size_t>(std::find(quad.begin(), quad.end(), v) - quad.begin());
}

/// Each quad in four at its middle, numbered as by catmull_clark_step.
std::vector<Quad> quartered(const QuadTopology& topology) {
  std::vector<Quad> quads;
  quads.reserve(4 * topology.quads.size());
  const int first_edge = topology.vertex_count(), first_quad = first_edge + static_cast<int>(topology.edges.size());
  for (std::size_t f = 0; f < topology.quads.size(); ++f) {
    for (std::size_t c = 0; c < 4; ++c) {
      quads.push_back({topology.quads[f][c], first_edge + topology.quad_edges[f][c], first_quad + static_cast<int>(f),
                       first_edge + topology.quad_edges[f][(c + 3) % 4]});
    }
  }
  return quads;
}

}  // namespace

struct SlimeModel::NumberedLayout {
  SampleLayout layout;
  std::vector<int> sample_of_node;
};

SlimeModel::SlimeModel(int vertex_count, const std::vector<Quad>& quads, QuadReference reference)
    : control_(quad_control(vertex_count, quads, std::move(reference), Border::refused)),
      bases_(std::make_shared<const std::map<int, SlimeBasis>>(bases_for(control_->topology))) {}

SlimeModel SlimeModel::start(int refinements) {
  const QuadMesh cube = cube_mesh();
  const SlimeModel bare(8, cube.quads, {});
  SlimeModel model(8, cube.quads, {fit_unit_sphere(bare.layout(kFitLevel), parameters_of(cube.vertices)), true});
  for (int i = 0; i < refinements; ++i) model = model.refine(model.reference()).first;
  return model;
}

std::vector<BlockKind> SlimeModel::blocks() const {
  return std::vector<BlockKind>(static_cast<std::size_t>(vertex_count()), BlockKind::point);
}

TriangleMesh SlimeModel::control_mesh(const Parameters& parameters) const {
  return split_quads({points_of(parameters), topology().quads});
}

SlimeModel::NumberedLayout SlimeModel::numbered_layout(int level) const {
  const QuadGrid grid(topology(), level);
  const int half = grid.intervals() / 2;
  std::map<int, SlimeWeights> tables;
  for (const auto& [n, basis] : *bases_) tables.emplace(n, basis.at(sector_points(basis, half)));
  NumberedLayout result;
  result.sample_of_node.assign(static_cast<std::size_t>(grid.node_count()), -1);
  LinearStencils stencils;
  int next = 0;
  for (int v = 0; v < vertex_count(); ++v) {
    const QuadRing& ring = topology().rings[static_cast<std::size_t>(v)];
    const SlimeWeights& table = tables.at(ring.valence());
    std::vector<SampleWeights> samples;
    for (int sector = 0; sector < ring.valence(); ++sector) {
      const int quad = ring.quad[static_cast<std::size_t>(sector)];
      const auto corner = static_cast<int>(corner_of(topology().quads[static_cast<std::size_t>(quad)], v));
      for (int j = 0; j <= half; ++j) {
        for (int i = 0; i <= half; ++i) {
          int& sample = result.sample_of_node[static_cast<std::size_t>(grid.node_from_corner(quad, corner, i, j))];
          if (sample >= 0) continue;
          sample = next++;
          samples.push_back(sample_weights(ring, v, table, j * (half + 1) + i, sector));
        }
      }
    }
    add_patch(result.layout, stencils, samples);
  }
  finish_layout(result.layout, std::move(stencils), grid, level, result.sample_of_node, control_->reference);
  return result;
}

SampleLayout SlimeModel::layout(int level) const {
  return numbered_layout(level).layout;
}

void SlimeModel::evaluate(const Parameters& parameters, const SampleLayout& layout, bool with_jacobian,
                          SurfaceSamples& samples) const {
  evaluate_linear(parameters, layout, with_jacobian, samples);
}

void SlimeModel::pull_back(const Parameters& /*parameters*/, const SampleLayout& layout, const std::vector<Vec3>& dE_dx,
                           std::vector<double>& gradient) const {
  pull_back_linear(layout, dE_dx, gradient);
}

PointRows SlimeModel::limit_rows() const {
  PointRows rows;
  std::map<int, SlimeWeights> tables;
  for (const auto& [n, basis] : *bases_) tables.emplace(n, basis.at({Eigen::Vector2d::Zero()}));
  for (int v = 0; v < vertex_count(); ++v) {
    const QuadRing& ring = topology().rings[static_cast<std::size_t>(v)];
    const SlimeWeights& table = tables.at(ring.valence());
    spread(
        ring, v, [&](int point) { return table.x(0, point); }, [&](int i, double w) { rows.add(i, w); });
    rows.close();
  }
  return rows;
}

std::pair<SlimeModel, Parameters> SlimeModel::refine(const Parameters& parameters) const {
  const std::vector<Quad> quads = quartered(topology());
  const int count = topology().vertex_count() + static_cast<int>(topology().edges.size() + topology().quads.size());
  const SlimeModel bare(count, quads, {});
  const NumberedLayout coarse = numbered_layout(kFitLevel + 1), fine = bare.numbered_layout(kFitLevel);
  const QuadGrid coarse_grid(topology(), kFitLevel + 1), fine_grid(bare.topology(), kFitLevel);
  std::vector<std::size_t> coarse_of_fine(static_cast<std::size_t>(fine.layout.sample_count()));
  std::vector<std::size_t> coarse_of_vertex(static_cast<std::size_t>(count));
  for (int f = 0; f < static_cast<int>(quads.size()); ++f) {
    for (int j = 0; j <= fine_grid.intervals(); ++j) {
      for (int i = 0; i <= fine_grid.intervals(); ++i) {
        const auto node = static_cast<std::size_t>(fine_grid.node(f, i, j));
        const auto there = static_cast<std::size_t>(
            coarse.sample_of_node[static_cast<std::size_t>(coarse_grid.node_from_corner(f / 4, f % 4, i, j))]);
        coarse_of_fine[static_cast<std::size_t>(fine.sample_of_node[node])] = there;
        if (node < coarse_of_vertex.size()) coarse_of_vertex[node] = there;
      }
    }
  }
  const ControlFit fit(fine.layout, count);
  const auto refined = [&](const Parameters& points) {
    SurfaceSamples samples;
    evaluate(points, coarse.layout, false, samples);
    std::vector<Vec3> target(coarse_of_fine.size()), prior(coarse_of_vertex.size());
    for (std::size_t i = 0; i < target.size(); ++i) target[i] = samples.x[coarse_of_fine[i]];
    for (std::size_t v = 0; v < prior.size(); ++v) prior[v] = samples.x[coarse_of_vertex[v]];
    return fit.solve(target, parameters_of(prior));
  };
  QuadReference reference = reference_shape();
  if (!reference.points.empty()) reference.points = refined(reference.points);
  if (reference.sphere) reference.points = fit_unit_sphere(fine.layout, reference.points);
  return {SlimeModel(count, quads, std::move(reference)), refined(parameters)};
}

PointRows thin_plate_rows(const SlimeModel& model) {
  std::map<int, Eigen::MatrixXd> factors;  // rows R with R^T R = K_n
  for (const auto& [n, basis] : model.bases()) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(basis.stiffness());
    const Eigen::VectorXd& values = eigen.eigenvalues();
    Eigen::Index first = 0;  // ascending; the null space comes first
    while (first < values.size() && values[first] < 1e-10 * values[values.size() - 1]) ++first;
    const Eigen::Index kept = values.size() - first;
    factors.emplace(n, values.tail(kept).cwiseSqrt().asDiagonal() * eigen.eigenvectors().rightCols(kept).transpose());
  }
  PointRows rows;
  for (int v = 0; v < model.vertex_count(); ++v) {
    const QuadRing& ring = model.topology().rings[static_cast<std::size_t>(v)];
    const Eigen::MatrixXd& factor = factors.at(ring.valence());
    for (Eigen::Index r = 0; r < factor.rows(); ++r) {
      spread(
          ring, v, [&](int point) { return factor(r, point); }, [&](int i, double w) { rows.add(i, w); });
      rows.close();
    }
  }
  return rows;
}

PointRows umbrella_rows(const QuadTopology& topology) {
  PointRows rows;
  for (int v = 0; v < topology.vertex_count(); ++v) {
    const QuadRing& ring = topology.rings[static_cast<std::size_t>(v)];
    rows.add(v, 1);
    for (const int e : ring.edge) rows.add(e, -1.0 / ring.valence());
    rows.close();
  }
  return rows;
}

}  // namespace pellicle
