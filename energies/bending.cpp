#include "pellicle/energies/bending.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "pellicle/energies/geometry.h"

namespace pellicle {

namespace {

// The sample itself, its neighbours, and theirs when the first ring is too small for six unknowns.
std::vector<int> stencil_of(const SampleGraph& graph, int sample) {
  std::vector<int> ring{sample};
  const auto add_neighbours = [&](int of) {
    for (int k = graph.start[static_cast<std::size_t>(of)]; k < graph.start[static_cast<std::size_t>(of) + 1]; ++k) {
      const int v = graph.neighbour[static_cast<std::size_t>(k)];
      if (std::find(ring.begin(), ring.end(), v) == ring.end()) ring.push_back(v);
    }
  };
  add_neighbours(sample);
  if (graph.degree(sample) < 5) {
    const std::size_t first_ring = ring.size();
    for (std::size_t k = 0; k < first_ring; ++k) add_neighbours(ring[k]);
  }
  return ring;
}

}  // namespace

VectorRows bending_rows(const SampleLayout& layout) {
  const std::vector<Vec3>& sphere = layout.on_unit_sphere;
  const SampleGraph graph(layout);
  const std::vector<double> area = sample_areas(layout, sphere);
  const double total = sum(area);
  VectorRows rows;
  for (int s = 0; s < layout.sample_count(); ++s) {
    const std::vector<int> ring = stencil_of(graph, s);
    const Vec3 n = sphere[static_cast<std::size_t>(s)].normalized();
    const Vec3 t1 = n.unitOrthogonal();
    const Vec3 t2 = n.cross(t1);
    double reach = 0.0;
    for (const int v : ring) reach = std::max(reach, (sphere[static_cast<std::size_t>(v)] - n).norm());
    const auto count = static_cast<Eigen::Index>(ring.size());
    Eigen::MatrixXd basis(count, 6);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Vec3& p = sphere[static_cast<std::size_t>(ring[static_cast<std::size_t>(i)])];
      const double u = p.dot(t1) / reach, v = p.dot(t2) / reach, w = (1.0 - p.dot(n)) / (reach * reach);
      basis.row(i) << 1.0, u, v, w, u * u - v * v, 2.0 * u * v;
    }
    // Rows 4 and 5 of the pseudo-inverse: the two components of the trace-free Hessian, up to a factor.
    const Eigen::MatrixXd inverse = basis.completeOrthogonalDecomposition().pseudoInverse();
    // f = c4 (u^2 - v^2) + 2 c5 u v has trace-free Hessian 2 [c4 c5; c5 -c4] / reach^2, squared norm 8 (c4^2 + c5^2).
    const double weight = std::sqrt(2.0 * 8.0 * area[static_cast<std::size_t>(s)] / total) / (reach * reach);
    for (const Eigen::Index component : {4, 5}) {
      for (Eigen::Index i = 0; i < count; ++i) {
        rows.add(ring[static_cast<std::size_t>(i)], weight * inverse(component, i));
      }
      rows.close();
    }
  }
  return rows;
}

}  // namespace pellicle
