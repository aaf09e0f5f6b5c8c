#include "pellicle/energies/bending.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "pellicle/energies/geometry.h"

namespace pellicle {

namespace {

/// Symmetric 2 x 2 matrices as (a11, sqrt(2) a12, a22): the dot product is Frobenius'.
using Form = Eigen::Vector3d;

/// 1/2 p^T Q p of the form's matrix.
double quadratic(const Form& q, double u, double v) {
  return 0.5 * (q[0] * u * u + q[2] * v * v) + q[1] * u * v / std::numbers::sqrt2;
}

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

/// Stencil of a sample on the reference shape, in its tangent plane and scaled to unit reach; w is the height below.
struct TangentStencil {
  Eigen::VectorXd u, v, w;
  double reach = 0.0;
  TangentStencil(const std::vector<Vec3>& reference, const std::vector<int>& ring, const Vec3& n)
      : u(ring.size()), v(ring.size()), w(ring.size()) {
    const Vec3& centre = reference[static_cast<std::size_t>(ring[0])];
    for (const int s : ring) reach = std::max(reach, (reference[static_cast<std::size_t>(s)] - centre).norm());
    const Vec3 t1 = n.unitOrthogonal(), t2 = n.cross(t1);
    for (Eigen::Index i = 0; i < u.size(); ++i) {
      const Vec3 d = (reference[static_cast<std::size_t>(ring[static_cast<std::size_t>(i)])] - centre) / reach;
      u[i] = d.dot(t1);
      v[i] = d.dot(t2);
      w[i] = -d.dot(n);
    }
  }
  /// Second fundamental form of the reference shape, by a least-squares quadric; times reach.
  Form curvature() const {
    Eigen::MatrixXd basis(u.size(), 6);
    for (Eigen::Index i = 0; i < u.size(); ++i) {
      basis.row(i) << 1.0, u[i], v[i], quadratic({1, 0, 0}, u[i], v[i]), quadratic({0, 1, 0}, u[i], v[i]),
          quadratic({0, 0, 1}, u[i], v[i]);
    }
    return basis.completeOrthogonalDecomposition().solve(w).tail<3>();
  }
};

/// Orthonormal forms that are penalised: across the reference's own curvature, or all where it is flat.
std::vector<Form> penalised(const Form& curvature, bool flat) {
  if (flat) return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const Form a = curvature.unitOrthogonal();
  return {a, curvature.normalized().cross(a)};
}

}  // namespace

VectorRows bending_rows(const SampleLayout& layout) {
  const std::vector<Vec3>& reference = layout.reference;
  const SampleGraph graph(layout);
  const std::vector<double> area = sample_areas(layout, reference);
  const std::vector<Vec3> normal = area_vectors(layout, reference);
  const double total = sum(area);
  const double radius = std::sqrt(total / (4.0 * std::numbers::pi));
  constexpr double kFlat = 0.1;  // curvature in units of 1/radius
  VectorRows rows;
  for (int s = 0; s < layout.sample_count(); ++s) {
    const auto own = static_cast<std::size_t>(s);
    const std::vector<int> ring = stencil_of(graph, s);
    const TangentStencil stencil(reference, ring, normal[own].normalized());
    const Form curvature = stencil.curvature();
    const bool flat = !(curvature.norm() * radius > kFlat * stencil.reach);
    const std::vector<Form> forms = penalised(curvature, flat);
    const auto count = static_cast<Eigen::Index>(ring.size());
    Eigen::MatrixXd basis(count, 4 + static_cast<Eigen::Index>(forms.size()) - (flat ? 1 : 0));
    const Eigen::Index first = basis.cols() - static_cast<Eigen::Index>(forms.size());
    for (Eigen::Index i = 0; i < count; ++i) {
      basis(i, 0) = 1.0;
      basis(i, 1) = stencil.u[i];
      basis(i, 2) = stencil.v[i];
      if (!flat) basis(i, 3) = stencil.w[i] / curvature.norm();
      for (std::size_t k = 0; k < forms.size(); ++k) {
        basis(i, first + static_cast<Eigen::Index>(k)) = quadratic(forms[k], stencil.u[i], stencil.v[i]);
      }
    }
    // Last rows of the pseudo-inverse: the components of the Hessian along the forms, times reach^2.
    const Eigen::MatrixXd inverse = basis.completeOrthogonalDecomposition().pseudoInverse();
    const double scale = radius / stencil.reach;
    const double weight = std::sqrt(2.0 * area[own] / total) * scale * scale;
    for (Eigen::Index k = first; k < basis.cols(); ++k) {
      for (Eigen::Index i = 0; i < count; ++i) {
        rows.add(ring[static_cast<std::size_t>(i)], weight * inverse(k, i));
      }
      rows.close();
    }
  }
  return rows;
}

}  // namespace pellicle
