// Where clouds of points end.
#include "pellicle/mesh/rim.h"

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
    for (const Vec3& x : rim) {
      // Points are 0.065 apart (0.046 on the smaller cap) and at random: rims are a few points wide.
      EXPECT_LE(x.z(), lowest + 0.2) << "of a cap of " << lowest;
      ++sectors[static_cast<std::size_t>((std::atan2(x.y(), x.x()) / std::numbers::pi + 1.0) * 5.999)];
    }
    EXPECT_THAT(sectors, testing::Each(testing::Ge(1)));
  }
}

TEST(RimOf, ClosedSurfacesHaveNone) {
  const PointTree tree(cap(3000, -1.0));
  EXPECT_EQ(rim_of(tree, plane_normals(tree)).x.size(), 0U);
}

}  // namespace
}  // namespace pellicle
