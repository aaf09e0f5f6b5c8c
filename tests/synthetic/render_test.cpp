#include "pellicle/synthetic/render.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pellicle/base/random.h"
#include "pellicle/synthetic/box_fraction.h"
#include "pellicle/synthetic/implicit_mesh.h"
#include "pellicle/synthetic/inner_ball.h"
#include "test_names.h"

namespace pellicle {
namespace {

TEST(BoxFraction, AgreesWithRandomPoints) {
  RandomEngine random(2);
  constexpr int kPoints = 20000;
  for (int trial = 0; trial < 100; ++trial) {
    const Vec3 normal(random.normal(), random.normal(), random.normal());
    const Vec3 half(random.uniform(0.1, 2.0), random.uniform(0.1, 2.0), random.uniform(0.1, 2.0));
    const double distance = random.uniform(-1.1, 1.1) * normal.cwiseAbs().dot(half);
    int inside = 0;
    for (int k = 0; k < kPoints; ++k) {
      const Vec3 u(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      inside += normal.dot(u.cwiseProduct(half)) + distance < 0.0 ? 1 : 0;
    }
    EXPECT_NEAR(box_fraction(distance, normal, half), static_cast<double>(inside) / kPoints, 0.018);
  }
}

TEST(BoxFraction, AlongAxesAndDiagonals) {
  const Vec3 half(0.5, 1.0, 2.0);
  EXPECT_NEAR(box_fraction(0.25, Vec3::UnitX(), half), 0.25, 1e-5);
  EXPECT_NEAR(box_fraction(-1.0, -Vec3::UnitZ(), half), 0.75, 1e-5);
  EXPECT_NEAR(box_fraction(0.0, Vec3(1, -2, 0.5), half), 0.5, 1e-12);
  EXPECT_NEAR(box_fraction(0.0, Vec3(1, 1, 0), Vec3::Constant(0.5)), 0.5, 1e-5);
  EXPECT_EQ(box_fraction(10.0, Vec3(1, 1, 1), half), 0.0);
  EXPECT_EQ(box_fraction(-10.0, Vec3(1, 1, 1), half), 1.0);
  // A corner tetrahedron of a unit cube: legs 1/2, volume 1/48.
  EXPECT_NEAR(box_fraction(1.0, Vec3(1, 1, 1), Vec3::Constant(0.5)), 1.0 / 48.0, 1e-12);
}

ImageGrid centred_grid(const Index3& size, const Vec3& spacing, const Mat3& direction) {
  ImageGrid grid{size, spacing, Vec3::Zero(), direction};
  grid.origin_in_world = -(grid.world_from_index_matrix() * (0.5 * Vec3(size[0] - 1, size[1] - 1, size[2] - 1)));
  return grid;
}

/// A ball of radius R convolved with a Gaussian, at distance r from its centre.
double blurred_ball(double radius, double sigma, double r) {
  const double s = std::sqrt(2.0) * sigma, lo = (radius - r) / s, hi = (radius + r) / s;
  const double tail =
      r > 1e-9 ? sigma / (std::sqrt(2.0 * std::numbers::pi) * r) * (std::exp(-lo * lo) - std::exp(-hi * hi)) : 0.0;
  return 0.5 * (std::erf(lo) + std::erf(hi)) - tail;
}

/// The mean of `f` over a voxel's box: three-point Gauss rule along each axis.
template <class F>
double box_mean(const ImageGrid& grid, const Vec3& index, const F& f) {
  const double node[3] = {-std::sqrt(0.15), 0.0, std::sqrt(0.15)}, weight[3] = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  double sum = 0.0;
  for (int k = 0; k < 3; ++k) {
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) {
        sum += weight[i] * weight[j] * weight[k] * f(grid.world_from_index(index + Vec3(node[i], node[j], node[k])));
      }
    }
  }
  return sum;
}

struct BlurCase {
  Vec3 spacing;
  double blur;
};

class BlurredBall : public testing::TestWithParam<BlurCase> {};
INSTANTIATE_TEST_SUITE_P(Grids, BlurredBall,
                         testing::Values(BlurCase{{1, 1, 1}, 1.0}, BlurCase{{1, 1, 1}, 0.5}, BlurCase{{1, 1, 1}, 2.3},
                                         BlurCase{{0.5, 0.5, 1.5}, 0.72}, BlurCase{{0.5, 0.5, 1.5}, 1.0},
                                         BlurCase{{0.4, 1.1, 3.0}, 1.0}));

/// The oracle knows neither of cells nor of kernels: a closed form and a quadrature over the voxel.
TEST_P(BlurredBall, EqualsTheClosedFormInEveryVoxel) {
  const BlurCase c = GetParam();
  const Mat3 turn = Eigen::AngleAxisd(0.6, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  const ImageGrid grid = centred_grid(
      {static_cast<int>(36 / c.spacing[0]), static_cast<int>(36 / c.spacing[1]), static_cast<int>(36 / c.spacing[2])},
      c.spacing, turn);
  const double radius = 10.0;
  const Body ball{make_shape("sphere", {radius}, 0.3, 1), Mat3::Identity(), Vec3(0.3, -0.2, 0.4)};
  const Image<float> image = fraction_of(ball, mesh_of(ball, mesh_cell(ball.shape)), grid, 0.0, c.blur);
  double worst = 0.0, sum = 0.0, squares = 0.0;
  int edge = 0;
  for (int k = 0; k < grid.size[2]; ++k) {
    for (int j = 0; j < grid.size[1]; ++j) {
      for (int i = 0; i < grid.size[0]; ++i) {
        const double expected = box_mean(
            grid, Vec3(i, j, k), [&](const Vec3& x) { return blurred_ball(radius, c.blur, (x - ball.center).norm()); });
        const double error = image.at(i, j, k) - expected;
        worst = std::max(worst, std::abs(error));
        if (expected > 0.02 && expected < 0.98) {
          squares += error * error;
          ++edge;
        }
        sum += image.at(i, j, k);
      }
    }
  }
  EXPECT_LE(worst, 4e-3);
  EXPECT_LE(std::sqrt(squares / edge), 1e-3);
  EXPECT_LE(std::abs(sum * grid.voxel_volume() / exact_volume(ball.shape) - 1.0), 2e-4);
}

class RenderedShape : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Shapes, RenderedShape, testing::ValuesIn(shape_names()), shape_test_name);

TEST_P(RenderedShape, FractionsAddUpToTheExactVolume) {
  const Body body{make_shape(GetParam(), {14.0}, 0.35, 9),
                  Eigen::AngleAxisd(0.9, Vec3(1, 1, -1).normalized()).toRotationMatrix(), Vec3(0.2, 0.1, -0.3)};
  const TriangleMesh surface = mesh_of(body, mesh_cell(body.shape));
  const ImageGrid grid = centred_grid({72, 72, 40}, {0.9, 0.9, 1.7}, Mat3::Identity());
  for (const double blur : {0.0, 1.0}) {
    double sum = 0.0;
    for (const float value : fraction_of(body, surface, grid, 0.0, blur).voxels) {
      ASSERT_GE(value, -1e-6F);
      ASSERT_LE(value, 1.0F + 1e-6F);
      sum += value;
    }
    EXPECT_LE(std::abs(sum * grid.voxel_volume() / exact_volume(body.shape) - 1.0), 5e-4) << "blur " << blur;
  }
}

TEST_P(RenderedShape, MaskEqualsTheSignAtEveryVoxelCentre) {
  const Body body{make_shape(GetParam(), {9.0}, 0.35, 9),
                  Eigen::AngleAxisd(0.9, Vec3(1, 1, -1).normalized()).toRotationMatrix(), Vec3(4.2, 0.1, -9.3)};
  Mat3 mirrored = Eigen::AngleAxisd(0.4, Vec3::UnitY()).toRotationMatrix();
  mirrored.col(0) *= -1.0;
  const ImageGrid grid = centred_grid({40, 44, 24}, {0.9, 0.8, 1.7}, mirrored);
  const Image<std::uint8_t> mask = mask_of(body, mesh_of(body, mesh_cell(body.shape)), grid);
  int wrong = 0, inside = 0;
  for (int k = 0; k < grid.size[2]; ++k) {
    for (int j = 0; j < grid.size[1]; ++j) {
      for (int i = 0; i < grid.size[0]; ++i) {
        const bool expected = body.level_at(grid.world_from_index(Vec3(i, j, k))).value < 0.0;
        wrong += expected != (mask.at(i, j, k) == 1) ? 1 : 0;
        inside += expected ? 1 : 0;
      }
    }
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(inside, 500);
}

/// Voxel centres inside and mean fractions: both tell the exact volume, the better the finer the voxels.
TEST(RenderedTori, MaskAndFractionsConvergeToTheExactVolume) {
  for (const std::string name : {"torus", "double-torus"}) {
    const Body body{make_shape(name, {14.0}, 0.35, 9),
                    Eigen::AngleAxisd(0.9, Vec3(1, 1, -1).normalized()).toRotationMatrix(), Vec3(0.2, 0.1, -0.3)};
    const TriangleMesh surface = mesh_of(body, mesh_cell(body.shape));
    const double exact = exact_volume(body.shape);
    for (const double h : {2.4, 1.2, 0.6}) {
      const int n = static_cast<int>(std::ceil(60.0 / h));
      const ImageGrid grid = centred_grid({n, n, n}, Vec3::Constant(h), Mat3::Identity());
      double inside = 0.0, fraction = 0.0;
      for (const std::uint8_t value : mask_of(body, surface, grid).voxels) inside += value;
      for (const float value : fraction_of(body, surface, grid, 0.0, 0.8).voxels) fraction += value;
      EXPECT_LE(std::abs(inside * grid.voxel_volume() / exact - 1.0), 0.006 * std::pow(h / 1.2, 1.5)) << name << h;
      EXPECT_LE(std::abs(fraction * grid.voxel_volume() / exact - 1.0), 1e-3 * h * h) << name << h;
    }
  }
}

/// A membrane's volume is known: the difference of two balls; of a smooth surface to second order, area * thickness.
TEST(Membrane, OfABallHasTheVolumeOfAShell) {
  const Body ball{make_shape("sphere", {12.0}, 0.3, 1), Mat3::Identity(), Vec3(0.3, -0.2, 0.4)};
  const ImageGrid grid = centred_grid({40, 40, 40}, {1, 1, 1}, Mat3::Identity());
  const TriangleMesh surface = mesh_of(ball, mesh_cell(ball.shape));
  for (const double thickness : {0.5, 3.0}) {
    double sum = 0.0;
    for (const float value : fraction_of(ball, surface, grid, thickness, 0.8).voxels) sum += value;
    const double outer = 12.0 + thickness / 2, inner = 12.0 - thickness / 2;
    const double expected = 4.0 / 3.0 * std::numbers::pi * (outer * outer * outer - inner * inner * inner);
    EXPECT_LE(std::abs(sum / expected - 1.0), 2e-3) << thickness;
  }
}

TEST(Rendering, ABodyOutsideTheVolumeLeavesNothing) {
  const Body ball{make_shape("sphere", {5.0}, 0.3, 1), Mat3::Identity(), Vec3(100, 0, 0)};
  const ImageGrid grid = centred_grid({20, 20, 20}, {1, 1, 1}, Mat3::Identity());
  const TriangleMesh surface = mesh_of(ball, mesh_cell(ball.shape));
  for (const float value : fraction_of(ball, surface, grid, 0.0, 1.0).voxels) ASSERT_EQ(value, 0.0F);
  for (const std::uint8_t value : mask_of(ball, surface, grid).voxels) ASSERT_EQ(value, 0);
}

/// Blur beyond the border: the part of the object outside the volume still shines in.
TEST(Rendering, ABodyCutByTheBorderIsBlurredAsIfTheVolumeWentOn) {
  const Body ball{make_shape("sphere", {8.0}, 0.3, 1), Mat3::Identity(), Vec3(9, 0, 0)};
  const TriangleMesh surface = mesh_of(ball, mesh_cell(ball.shape));
  const ImageGrid small = centred_grid({20, 20, 20}, {1, 1, 1}, Mat3::Identity());
  const ImageGrid large = centred_grid({60, 20, 20}, {1, 1, 1}, Mat3::Identity());
  const Image<float> a = fraction_of(ball, surface, small, 0.0, 1.5), b = fraction_of(ball, surface, large, 0.0, 1.5);
  for (int k = 0; k < 20; ++k) {
    for (int j = 0; j < 20; ++j) {
      for (int i = 0; i < 20; ++i) ASSERT_NEAR(a.at(i, j, k), b.at(i + 20, j, k), 1e-6);
    }
  }
}

}  // namespace
}  // namespace pellicle
