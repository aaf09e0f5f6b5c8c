#include "pellicle/synthetic/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pellicle/base/errors.h"
#include "pellicle/base/random.h"
#include "pellicle/image/image_grid.h"
#include "test_names.h"

namespace pellicle {
namespace {

constexpr double kPi = std::numbers::pi;

class EveryShape : public testing::TestWithParam<std::string> {
 protected:
  Shape shape_ = make_shape(GetParam(), {7.0}, 0.35, 3);
};
INSTANTIATE_TEST_SUITE_P(Shapes, EveryShape, testing::ValuesIn(shape_names()), shape_test_name);

Vec3 draw_in_box(RandomEngine& random, const Vec3& half) {
  return {random.uniform(-half.x(), half.x()), random.uniform(-half.y(), half.y()),
          random.uniform(-half.z(), half.z())};
}

TEST_P(EveryShape, GradientIsTheSlopeOfTheValueNearTheSurface) {
  RandomEngine random(11);
  int tested = 0;
  while (tested < 500) {
    const Vec3 x = draw_in_box(random, half_bounds(shape_));
    const LevelSample s = level(shape_, x);
    if (std::abs(s.value) > 0.3 * s.gradient.norm()) continue;
    constexpr double kStep = 1e-5;
    Vec3 slope;
    for (int a = 0; a < 3; ++a) {
      const Vec3 d = kStep * Vec3::Unit(a);
      slope[a] = (level(shape_, x + d).value - level(shape_, x - d).value) / (2.0 * kStep);
    }
    EXPECT_LE((slope - s.gradient).norm(), 1e-6 * s.gradient.norm()) << x.transpose();
    ++tested;
  }
}

TEST_P(EveryShape, LiesInItsBoundsAndFillsThem) {
  const Vec3 half = half_bounds(shape_);
  RandomEngine random(5);
  Vec3 reach = Vec3::Zero();
  for (int k = 0; k < 200000; ++k) {
    const Vec3 x = draw_in_box(random, 1.5 * half);
    if (level(shape_, x).value < 0.0) reach = reach.cwiseMax(x.cwiseAbs());
  }
  for (int a = 0; a < 3; ++a) {
    EXPECT_LE(reach[a], half[a]);
    EXPECT_GE(reach[a], 0.6 * half[a]);
  }
}

TEST_P(EveryShape, ExactVolumeAgreesWithRandomPoints) {
  const Vec3 half = half_bounds(shape_);
  RandomEngine random(6);
  constexpr int kPoints = 400000;
  int inside = 0;
  for (int k = 0; k < kPoints; ++k) inside += level(shape_, draw_in_box(random, half)).value < 0.0 ? 1 : 0;
  const double share = static_cast<double>(inside) / kPoints;
  const double deviation = std::sqrt(share * (1.0 - share) / kPoints);
  EXPECT_LE(std::abs(exact_volume(shape_) / (8.0 * half.prod()) - share), 4.0 * deviation);
}

TEST_P(EveryShape, VolumeScalesWithTheCube) {
  const Shape twice = make_shape(GetParam(), {14.0}, 0.35, 3);
  EXPECT_LE(std::abs(exact_volume(twice) / exact_volume(shape_) - 8.0), 1e-9);
}

TEST_P(EveryShape, FootPointIsOnTheSurfaceAndStraightBelow) {
  RandomEngine random(8);
  Body body{shape_, Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix(), Vec3(3, -4, 5)};
  int tested = 0;
  while (tested < 200) {
    const Vec3 x = body.center + body.world_from_shape * draw_in_box(random, 1.1 * half_bounds(shape_));
    if (!(std::abs(body.distance_near(x)) <= 0.4)) continue;
    const Vec3 foot = body.closest_point_near(x);
    const LevelSample s = body.level_at(foot);
    EXPECT_LE(std::abs(s.value) / s.gradient.norm(), 1e-6);
    EXPECT_LE((x - foot).cross(s.gradient.normalized()).norm(), 1e-5);
    ++tested;
  }
}

TEST(ShapeVolumes, ClosedForms) {
  EXPECT_NEAR(exact_volume(make_shape("sphere", {2.0}, 0.3, 1)), 32.0 / 3.0 * kPi, 1e-12);
  EXPECT_NEAR(exact_volume(make_shape("ellipsoid", {1.0, 2.0, 3.0}, 0.3, 1)), 8.0 * kPi, 1e-12);
  EXPECT_NEAR(exact_volume(make_shape("bean", {1.0, 2.0, 3.0}, 0.3, 1)), 8.0 * kPi, 1e-12);
  EXPECT_NEAR(exact_volume(make_shape("torus", {3.0, 1.0}, 0.3, 1)), 6.0 * kPi * kPi, 1e-12);
  // One ball when the blend and the distance of the two vanish: the quadrature meets the closed form.
  EXPECT_NEAR(exact_volume(DumbbellShape{1.5, 0.0, 1e-9}), 4.5 * kPi, 1e-7);
  EXPECT_NEAR(exact_volume(BlobShape{2.0, 1.0, {}}), 32.0 / 3.0 * kPi, 1e-10);
  // (1 + c P_2)^3 / 3 over the sphere: 4 pi (1/3 + c^2/5 + 2 c^3/105).
  EXPECT_NEAR(exact_volume(BlobShape{1.0, 1.3, {{2, Vec3::UnitX(), 0.3}}}),
              4.0 * kPi * (1.0 / 3.0 + 0.09 / 5.0 + 2.0 * 0.027 / 105.0), 1e-10);
}

/// Counted on a fine lattice, which knows nothing of sections and heights.
TEST(ShapeVolumes, OfTheDoubleTorusAgreesWithALattice) {
  const Shape shape = make_shape("double-torus", {2.0, 0.8}, 0.3, 1);
  const Vec3 half = half_bounds(shape);
  constexpr double kStep = 0.02;
  const Index3 n{static_cast<int>(half.x() / kStep) + 1, static_cast<int>(half.y() / kStep) + 1,
                 static_cast<int>(half.z() / kStep) + 1};
  double sum = 0.0;  // of the octant, each cell by its plane
  for (int k = 0; k < n[2]; ++k) {
    for (int j = 0; j < n[1]; ++j) {
      for (int i = 0; i < n[0]; ++i) {
        const LevelSample s = level(shape, kStep * (Vec3(i, j, k) + Vec3::Constant(0.5)));
        sum += std::clamp(0.5 - s.value / (s.gradient.norm() * kStep), 0.0, 1.0);
      }
    }
  }
  EXPECT_LE(std::abs(8.0 * sum * kStep * kStep * kStep / exact_volume(shape) - 1.0), 2e-4);
}

TEST(Tori, HaveTheirHoles) {
  const Shape torus = make_shape("torus", {1.0}, 0.35, 1), both = make_shape("double-torus", {2.0, 0.8}, 0.35, 1);
  EXPECT_GT(level(torus, {0, 0, 0}).value, 0.0);
  EXPECT_LT(level(torus, {0, 1, 0}).value, 0.0);
  EXPECT_NEAR(level(torus, {0, 1, 0.4}).value, 0.0, 1e-12);
  EXPECT_LT(level(both, {0, 0, 0}).value, 0.0);
  for (const double side : {-1.0, 1.0}) {
    EXPECT_GT(level(both, {2.0 * side, 0, 0}).value, 0.0);
    EXPECT_LT(level(both, {2.0 * side, 2.0, 0}).value, 0.0);
    EXPECT_LT(level(both, {4.0 * side, 0, 0}).value, 0.0);
  }
}

TEST(Blob, HasItsAmplitudeAndComesFromItsSeed) {
  const auto radius_at = [](const Shape& blob, const Vec3& u) { return 1.0 - level(blob, u).value; };
  const Shape blob = make_shape("blob", {1.0}, 0.35, 7), same = make_shape("blob", {1.0}, 0.35, 7);
  const Shape other = make_shape("blob", {1.0}, 0.35, 8);
  RandomEngine random(1);
  double largest = 0.0, apart = 0.0;
  for (int k = 0; k < 100000; ++k) {
    const Vec3 u = Vec3(random.normal(), random.normal(), random.normal()).normalized();
    largest = std::max(largest, std::abs(radius_at(blob, u) - 1.0));
    apart = std::max(apart, std::abs(radius_at(blob, u) - radius_at(other, u)));
    ASSERT_EQ(radius_at(blob, u), radius_at(same, u));
  }
  EXPECT_NEAR(largest, 0.35, 0.005);
  EXPECT_GE(apart, 0.1);
}

TEST(Bean, AndDumbbellAndTubeAreNotConvex) {
  // The middle between two points of the solid lies outside.
  const Shape bean = make_shape("bean", {1.0}, 0.35, 1), dumbbell = make_shape("dumbbell", {1.0}, 0.35, 1);
  const Vec3 tip(0.9, 0.8, 0);
  EXPECT_LT(level(bean, tip).value, 0.0);
  EXPECT_LT(level(bean, {-tip.x(), tip.y(), 0}).value, 0.0);
  EXPECT_GT(level(bean, {0, tip.y(), 0}).value, 0.0);
  EXPECT_LT(level(dumbbell, {0.9, 0.7, 0}).value, 0.0);
  EXPECT_GT(level(dumbbell, {0, 0.7, 0}).value, 0.0);
  EXPECT_LT(level(dumbbell, {0, 0.3, 0}).value, 0.0);
}

TEST(MakeShape, RefusesWhatDoesNotFit) {
  EXPECT_THROW(make_shape("cube", {1.0}, 0.3, 1), UsageError);
  EXPECT_THROW(make_shape("sphere", {}, 0.3, 1), UsageError);
  EXPECT_THROW(make_shape("sphere", {1, 2, 3}, 0.3, 1), UsageError);
  EXPECT_THROW(make_shape("ellipsoid", {1, 2}, 0.3, 1), UsageError);
  EXPECT_THROW(make_shape("ellipsoid", {1, 2, 100}, 0.3, 1), UsageError);
  EXPECT_THROW(make_shape("torus", {1, 2}, 0.3, 1), UsageError);
  EXPECT_THROW(make_shape("torus", {30, 20, 10}, 0.3, 1), UsageError);
  EXPECT_THROW(make_shape("double-torus", {100, 2}, 0.3, 1), UsageError);
  EXPECT_THROW(make_shape("sphere", {2, 1}, 0.3, 1), UsageError);
  EXPECT_THROW(make_shape("sphere", {-1.0}, 0.3, 1), UsageError);
  EXPECT_THROW(make_shape("sphere", {std::nan("")}, 0.3, 1), UsageError);
}

}  // namespace
}  // namespace pellicle
