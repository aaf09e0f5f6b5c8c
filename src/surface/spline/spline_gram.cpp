#include "pellicle/surface/spline/spline_gram.h"

#include "pellicle/surface/internal/gauss_legendre.h"

namespace pellicle {

Eigen::MatrixXd gram_matrix(const SplineAxis& axis) {
  const Quadrature rule = gauss_legendre(8);
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(axis.rows(), axis.rows());
  for (int cell = 0; cell < axis.m(); ++cell) {
    for (std::size_t q = 0; q < rule.at.size(); ++q) {
      const AxisWeights b = axis.at(cell + rule.at[q]);
      for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < 4; ++j) gram(b.row[i], b.row[j]) += rule.weight[q] / axis.m() * (b.value[i] * b.value[j]);
      }
    }
  }
  return gram;
}

Eigen::MatrixXd gram_matrix(const SplineModel& model) {
  const Eigen::MatrixXd by_u = gram_matrix(model.along_u()), by_v = gram_matrix(model.along_v());
  const Eigen::Index columns = by_u.rows();
  // Blocks from the grid of control points: A^T (G_v x G_u) A with the rows of A from control()
  std::vector<std::vector<BlockWeight>> controls;
  for (int row_v = 0; row_v < by_v.rows(); ++row_v) {
    for (int row_u = 0; row_u < columns; ++row_u) controls.push_back(model.control(row_u, row_v));
  }
  const auto blocks = static_cast<Eigen::Index>(model.blocks().size());
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(blocks, blocks);
  for (std::size_t i = 0; i < controls.size(); ++i) {
    for (std::size_t j = 0; j < controls.size(); ++j) {
      const auto iu = static_cast<Eigen::Index>(i) % columns, iv = static_cast<Eigen::Index>(i) / columns;
      const auto ju = static_cast<Eigen::Index>(j) % columns, jv = static_cast<Eigen::Index>(j) / columns;
      const double g = by_u(iu, ju) * by_v(iv, jv);
      if (g == 0.0) continue;
      for (const auto& [a, wa] : controls[i]) {
        for (const auto& [b, wb] : controls[j]) gram(a, b) += wa * wb * g;
      }
    }
  }
  return gram;
}

double inner_product(const SplineModel& model, const Parameters& a, const Parameters& b) {
  const Eigen::MatrixXd by_u = gram_matrix(model.along_u()), by_v = gram_matrix(model.along_v());
  const std::vector<Vec3> grid_a = model.control_grid(a), grid_b = model.control_grid(b);
  using Coordinates = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::Stride<Eigen::Dynamic, 3>>;
  const auto coordinate = [&](const std::vector<Vec3>& grid, int axis) {
    return Coordinates(grid.front().data() + axis, by_u.rows(), by_v.rows(), {3 * by_u.rows(), 3});
  };
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::MatrixXd image = by_u * coordinate(grid_b, axis) * by_v;
    sum += coordinate(grid_a, axis).cwiseProduct(image).sum();
  }
  return sum;
}

}  // namespace pellicle
