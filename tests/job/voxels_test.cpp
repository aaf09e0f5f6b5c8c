#include "pellicle/job/voxels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "../all_grids.h"

namespace pellicle {
namespace {

TEST(Voxels, BoxHoldsTheMeshAndStaysInside) {
  const NormalModel model = NormalModel::start(StartSolid::octahedron, SubdivisionRule::smooth);
  for (const auto& grid : test::all_grids()) {
    const TriangleMesh ball = tessellate({model, affine_image(model, Vec3(5, 4, -9), 6.0 * Mat3::Identity())}, 3);
    const Box box = box_around(ball, grid, 1);
    ASSERT_FALSE(box.empty());
    for (std::size_t a = 0; a < 3; ++a) {
      EXPECT_GE(box.first[a], 0);
      EXPECT_LE(box.first[a] + box.grid.size[a], grid.size[a]);
    }
    for (const auto& v : ball.vertices) {
      if (grid.contains(v)) {
        EXPECT_TRUE(box.grid.contains(v));
      }
    }
    const TriangleMesh away = tessellate({model, affine_image(model, Vec3(500, 0, 0), Mat3::Identity())}, 2);
    EXPECT_TRUE(box_around(away, grid, 2).empty());
  }
}

TEST(SignedDistance, OfABallIsThatOfABall) {
  const NormalModel model = NormalModel::start(StartSolid::tetrahedron, SubdivisionRule::smooth);
  const Vec3 center(1, 2, 3);
  const Surface ball{model, affine_image(model, center, 6.0 * Mat3::Identity())};
  ImageGrid grid;
  grid.size = {50, 40, 30};
  grid.spacing = {0.7, 0.9, 1.2};
  grid.origin_in_world = {-16, -17, -15};
  const Image<float> distance = signed_distance(ball, tessellate(ball, 6), grid);
  double worst_near = 0.0, worst_far = 0.0;
  for (int k = 0; k < grid.size[2]; ++k) {
    for (int j = 0; j < grid.size[1]; ++j) {
      for (int i = 0; i < grid.size[0]; ++i) {
        const double exact = (grid.world_from_index(Vec3(i, j, k)) - center).norm() - 6.0;
        const double error = std::abs(static_cast<double>(distance.at(i, j, k)) - exact);
        double& worst = std::abs(exact) < 9.0 * grid.mean_spacing() ? worst_near : worst_far;
        worst = std::max(worst, std::abs(exact) < 9.0 * grid.mean_spacing() ? error : error / std::abs(exact));
      }
    }
  }
  EXPECT_LE(worst_near, 0.01);  // chords of the tessellation
  EXPECT_GT(worst_far, 0.0);
  EXPECT_LE(worst_far, 0.01);
}

}  // namespace
}  // namespace pellicle
