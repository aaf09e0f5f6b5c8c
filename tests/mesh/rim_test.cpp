// Where clouds of points end.
#include "pellicle/mesh/points/rim.h"

#include <gmock/gmock.h>

#include <array>
#include <numbers>

#include "pellicle/base/random.h"
#include "test_meshes.h"

namespace pellicle {
namespace {

/// Points of a unit sphere above this height, evenly at random.
std::vector<Vec3> cap(int count, double lowest) {
  RandomEngine random(5);
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    const double z = random.uniform(lowest, 1.0), angle = random.uniform(0.0, 2.0 * std::numbers::pi);
    points.emplace_back(std::sqrt(1.0 - z * z) * std::cos(angle), std::sqrt(1.0 - z * z) * std::sin(angle), z);
  }
  return points;
}

TEST(PlaneNormals, AreThoseOfTheSphere) {
  const PointTree tree(cap(1500, -1.0));
  const std::vector<Vec3> normals = plane_normals(tree);
  for (std::size_t i = 0; i < normals.size(); ++i) EXPECT_GE(std::abs(normals[i].dot(tree.points()[i])), 0.97);
}

TEST(RimOf, IsAllAroundTheMouthAndNowhereElse) {
  for (const double lowest : {0.0, 0.5}) {
    const PointTree tree(cap(1500, lowest));
    const std::vector<Vec3> rim = rim_of(tree, plane_normals(tree)).x;
    std::array<int, 12> sectors{};
    int deep = 0;
    for (const Vec3& x : rim) {
      // Points are 0.065 apart (0.046 on the smaller cap) and at random: rims are a few points wide.
      deep += x.z() > lowest + 0.2 ? 1 : 0;
      ++sectors[static_cast<std::size_t>((std::atan2(x.y(), x.x()) / std::numbers::pi + 1.0) * 5.999)];
    }
    EXPECT_THAT(sectors, testing::Each(testing::Ge(1)));
    EXPECT_LE(deep, static_cast<int>(rim.size() / 20)) << "of a cap of " << lowest;
  }
}

TEST(RimOf, ClosedSurfacesHaveNone) {
  const PointTree tree(cap(3000, -1.0));
  EXPECT_EQ(rim_of(tree, plane_normals(tree)).x.size(), 0U);
}

TEST(RimOf, OutwardLeadsAwayFromThePoints) {
  const PointTree tree(cap(1500, 0.5));
  const RimPoints rim = rim_of(tree, plane_normals(tree));
  ASSERT_EQ(rim.x.size(), rim.outward.size());
  int inside = 0;
  for (std::size_t i = 0; i < rim.x.size(); ++i) {
    EXPECT_NEAR(rim.outward[i].norm(), 1.0, 1e-9);
    EXPECT_LE(std::abs(rim.outward[i].dot(rim.x[i])), 0.3);
    inside += rim.outward[i].z() > -0.3 ? 1 : 0;  // straight down is -cos(30 degrees); not at gaps by chance
  }
  EXPECT_LE(inside, static_cast<int>(rim.x.size() / 20));
}

/// Angles by which a closed curve turns, over 2 pi.
double turning_of(const std::vector<Vec3>& x) {
  double sum = 0.0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const Vec3 before = x[(k + 1) % x.size()] - x[k], after = x[(k + 2) % x.size()] - x[(k + 1) % x.size()];
    sum += std::atan2(before.cross(after).norm(), before.dot(after));
  }
  return sum / (2.0 * std::numbers::pi);
}

TEST(RimCurves, ARoughStartEndsOnTheSmoothRim) {
  for (const double lowest : {0.0, 0.5}) {
    const PointTree tree(cap(1500, lowest));
    const RimPoints rim = rim_of(tree, plane_normals(tree));
    RandomEngine random(2);
    std::vector<Vec3> start;
    for (int k = 0; k < 16; ++k) {
      const double angle = k * std::numbers::pi / 8, z = lowest + random.uniform(-0.2, 0.2), r = std::sqrt(1.0 - z * z);
      start.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
    }
    const std::vector<RimCurve> curves = rim_curves({start}, rim);
    ASSERT_EQ(curves.size(), 1U);
    EXPECT_EQ(curves[0].points, static_cast<int>(rim.x.size()));
    const std::vector<Vec3>& x = curves[0].x;
    double squares = 0.0;
    for (std::size_t k = 0; k < x.size(); ++k) {
      squares += std::pow(x[k].z() - lowest, 2) / static_cast<double>(x.size());
      EXPECT_NEAR(x[k].norm(), 1.0, 0.03);
      EXPECT_NEAR(curves[0].tangent[k].dot(curves[0].outward[k]), 0.0, 1e-9);
      EXPECT_LE(curves[0].outward[k].z(), -0.3);
    }
    EXPECT_LE(std::sqrt(squares), 0.035);  // half of the distance between points
    EXPECT_LE(turning_of(x), 1.1);
  }
}

TEST(RimCurves, PointsFarOffCountForNothing) {
  const PointTree tree(cap(1500, 0.0));
  RimPoints rim = rim_of(tree, plane_normals(tree));
  std::vector<Vec3> start;
  for (int k = 0; k < 16; ++k)
    start.emplace_back(std::cos(k * std::numbers::pi / 8), std::sin(k * std::numbers::pi / 8), 0.1);
  const std::vector<Vec3> before = rim_curves({start}, rim)[0].x;
  rim.x.emplace_back(0.6, 0.0, -0.8);
  rim.outward.emplace_back(0.8, 0.0, -0.6);
  const std::vector<Vec3> after = rim_curves({start}, rim)[0].x;
  for (std::size_t k = 0; k < before.size(); ++k) EXPECT_NEAR((before[k] - after[k]).norm(), 0.0, 0.01);
}

TEST(RimCurves, EachRimOfATubeHasItsOwn) {
  std::vector<std::vector<Vec3>> starts;
  RimPoints rim;
  for (const double z : {-1.0, 1.0}) {
    std::vector<Vec3>& start = starts.emplace_back();
    for (int k = 0; k < 60; ++k) {
      const double angle = k * std::numbers::pi / 30;
      if (k % 6 == 0) start.emplace_back(1.2 * std::cos(angle), 1.2 * std::sin(angle), 0.7 * z);
      rim.x.emplace_back(std::cos(angle), std::sin(angle), z);
      rim.outward.emplace_back(0.0, 0.0, z);
    }
  }
  const std::vector<RimCurve> curves = rim_curves(starts, rim);
  ASSERT_EQ(curves.size(), 2U);
  const RimLocator locator(curves);
  const RimLocator::Place place = locator.nearest({2.0, 0.0, 1.1});
  EXPECT_EQ(place.curve, 1);
  EXPECT_NEAR((place.x - Vec3(1, 0, 1)).norm(), 0.0, 0.01);
  EXPECT_NEAR(std::abs(place.tangent.y()), 1.0, 1e-3);
  EXPECT_NEAR(place.outward.z(), 1.0, 1e-3);
}

}  // namespace
}  // namespace pellicle
