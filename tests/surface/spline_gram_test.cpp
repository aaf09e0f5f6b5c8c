#include "pellicle/surface/spline/spline_gram.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "pellicle/surface/internal/gauss_legendre.h"
#include "spline_cases.h"

namespace pellicle {
namespace {

TEST(GaussLegendre, IsExactForPolynomialsOfItsDegree) {
  for (int n = 1; n <= 12; ++n) {
    const Quadrature rule = gauss_legendre(n);
    ASSERT_EQ(rule.at.size(), std::size_t(n));
    for (int degree = 0; degree < 2 * n; ++degree) {
      double sum = 0;
      for (int i = 0; i < n; ++i) sum += rule.weight[i] * std::pow(rule.at[i], degree);
      EXPECT_NEAR(sum, 1.0 / (degree + 1), 2e-15) << n << " points, degree " << degree;
    }
    EXPECT_TRUE(std::is_sorted(rule.at.begin(), rule.at.end()));
  }
}

TEST(SplineGram, AxisMatrixMatchesDenseSums) {
  for (const SplineModel& model : shapes::all_splines()) {
    for (const SplineAxis& axis : {model.along_u(), model.along_v()}) {
      const Eigen::MatrixXd gram = gram_matrix(axis);
      Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(axis.rows(), axis.rows());
      const int steps = 400;  // midpoints an interval
      for (int s = 0; s < steps * axis.m(); ++s) {
        const double knots = (s + 0.5) / steps;
        Eigen::VectorXd basis = Eigen::VectorXd::Zero(axis.rows());  // from the generator, over all its periods
        for (int k = -1; k <= axis.m() + 1; ++k) {
          const int period = axis.closed() ? axis.m() : 1;
          if (axis.closed() && (k < 0 || k >= axis.m())) continue;
          for (int turn = axis.closed() ? -1 : 0; turn <= (axis.closed() ? 1 : 0); ++turn) {
            basis[axis.row(k)] += axis.phi().at(knots - k + turn * period).value;
          }
        }
        dense += basis * basis.transpose() / (steps * axis.m());
      }
      EXPECT_LE((gram - dense).cwiseAbs().maxCoeff(), 2e-6);
      EXPECT_EQ(gram, gram.transpose());
      EXPECT_NEAR(gram.sum(), 1.0, 1e-14) << "partition of unity";
      EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(gram).eigenvalues().minCoeff(), 0.0);
    }
  }
}

TEST(SplineGram, PeriodicMatrixIsCirculant) {
  const Eigen::MatrixXd gram = gram_matrix(shapes::spline_sphere(9, 3).along_u());
  for (int i = 0; i < 9; ++i) {
    for (int j = 0; j < 9; ++j) EXPECT_NEAR(gram(i, j), gram(0, (j - i + 9) % 9), 1e-16);
  }
  EXPECT_EQ(gram(0, 4), 0.0) << "supports four apart do not meet";
}

TEST(SplineGram, InnerProductsOfSurfaces) {
  RandomEngine random(21);
  for (const SplineModel& model : shapes::all_splines()) {
    const Parameters a = shapes::perturbed(model, 0.3, random), b = shapes::perturbed(model, 0.3, random);
    double dense = 0;
    const int n = 120;
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const double u = (i + 0.5) / n, v = (j + 0.5) / n;
        dense += model.at(a, u, v).x.dot(model.at(b, u, v).x) / (n * n);
      }
    }
    const double product = inner_product(model, a, b);
    EXPECT_NEAR(product, dense, 3e-3);
    const Eigen::MatrixXd gram = gram_matrix(model);
    const auto blocks = gram.rows();
    double by_blocks = 0;
    for (int axis = 0; axis < 3; ++axis) {
      Eigen::VectorXd x(blocks), y(blocks);
      for (int k = 0; k < blocks; ++k) {
        x[k] = shapes::block(a, k)[axis];
        y[k] = shapes::block(b, k)[axis];
      }
      by_blocks += x.dot(gram * y);
    }
    EXPECT_NEAR(product, by_blocks, 1e-13);
    EXPECT_NEAR(product, inner_product(model, b, a), 1e-13);
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(gram).eigenvalues().minCoeff(), 0.0);
  }
}

TEST(SplineGram, UnitSphereAndTorusHaveKnownNorms) {
  const SplineModel sphere = shapes::spline_sphere(7, 5);
  EXPECT_NEAR(inner_product(sphere, sphere.reference(), sphere.reference()), 1.0, 1e-12);
  const SplineModel torus({.topology = SplineTopology::torus, .m1 = 6, .m2 = 5, .reference_ratio = 0.3});
  EXPECT_NEAR(inner_product(torus, torus.reference(), torus.reference()), 1.0 + 0.3 * 0.3, 1e-12);
}

}  // namespace
}  // namespace pellicle
