#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pellicle/mesh/measure.h"
#include "pellicle/synthetic/implicit_mesh.h"
#include "pellicle/synthetic/inner_ball.h"
#include "test_names.h"

namespace pellicle {
namespace {

class TruthSurface : public testing::TestWithParam<std::string> {
 protected:
  Body body_{make_shape(GetParam(), {20.0}, 0.35, 4),
             Eigen::AngleAxisd(1.1, Vec3(2, -1, 1).normalized()).toRotationMatrix(), Vec3(-10, 20, 30)};
};
INSTANTIATE_TEST_SUITE_P(Shapes, TruthSurface, testing::ValuesIn(shape_names()), shape_test_name);

TEST_P(TruthSurface, IsClosedAndHasItsGenus) {
  const TriangleMesh mesh = mesh_of(body_, mesh_cell(body_.shape));
  const MeshTopology topology = topology_of(mesh);
  EXPECT_TRUE(topology.closed && topology.manifold && topology.oriented) << topology.first_fault;
  EXPECT_EQ(topology.components, 1);
  EXPECT_EQ(topology.genus, shape_genus(GetParam()));
  EXPECT_GT(volume_of(mesh), 0.0);
  EXPECT_EQ(self_intersection_count(mesh), 0U);
  EXPECT_GE(mesh.triangles.size(), 20000U);
  EXPECT_LE(mesh.triangles.size(), shape_genus(GetParam()) == 0 ? 45000U : 75000U);
}

TEST_P(TruthSurface, VerticesAreExactAndNormalsPointOut) {
  const TriangleMesh mesh = mesh_of(body_, mesh_cell(body_.shape));
  ASSERT_EQ(mesh.normals.size(), mesh.vertices.size());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    ASSERT_LE(std::abs(body_.distance_near(mesh.vertices[v])), 1e-9);
    ASSERT_LE(std::abs(mesh.normals[v].norm() - 1.0), 1e-12);
    ASSERT_GT(body_.level_at(mesh.vertices[v] + 0.05 * mesh.normals[v]).value, 0.0);
    ASSERT_LT(body_.level_at(mesh.vertices[v] - 0.05 * mesh.normals[v]).value, 0.0);
  }
}

TEST_P(TruthSurface, TrianglesAreWellShaped) {
  const TriangleMesh mesh = mesh_of(body_, mesh_cell(body_.shape));
  double largest_cosine = -1.0, lowest_agreement = 1.0;
  for (const auto& t : mesh.triangles) {
    Vec3 x[3];
    for (std::size_t c = 0; c < 3; ++c) x[c] = mesh.vertices[static_cast<std::size_t>(t[c])];
    const Vec3 facet = (x[1] - x[0]).cross(x[2] - x[0]).normalized();
    for (int c = 0; c < 3; ++c) {
      const Vec3 a = (x[(c + 1) % 3] - x[c]).normalized(), b = (x[(c + 2) % 3] - x[c]).normalized();
      largest_cosine = std::max(largest_cosine, a.dot(b));
    }
    for (const int v : t) {
      lowest_agreement = std::min(lowest_agreement, facet.dot(mesh.normals[static_cast<std::size_t>(v)]));
    }
  }
  EXPECT_LE(largest_cosine, std::cos(22.0 * 3.14159 / 180.0));
  EXPECT_GE(lowest_agreement, 0.97);
}

TEST_P(TruthSurface, VolumeConvergesToTheExactOneAtSecondOrder) {
  const double cell = mesh_cell(body_.shape), exact = exact_volume(body_.shape);
  const double coarse = 1.0 - volume_of(mesh_of(body_, 2.0 * cell)) / exact;
  const double fine = 1.0 - volume_of(mesh_of(body_, cell)) / exact;
  EXPECT_LE(std::abs(fine), 8e-4);
  EXPECT_GE(coarse / fine, 3.6);
  EXPECT_LE(coarse / fine, 4.4);
  // What is left after extrapolation is below a tenth of a per mille: volume and mesh know nothing of one another.
  EXPECT_LE(std::abs(fine - (coarse - fine) / 3.0), 3e-5);
}

TEST_P(TruthSurface, InnerBallFitsAndTouches) {
  const TriangleMesh mesh = mesh_of(body_, mesh_cell(body_.shape));
  const InnerBall ball = inner_ball(body_, mesh);
  double nearest = 1e300;
  for (const Vec3& v : mesh.vertices) nearest = std::min(nearest, (v - ball.center).norm());
  EXPECT_LE(std::abs(nearest - ball.radius), 1e-9);
  // No lattice point of the solid is deeper by more than the search's own resolution.
  const Vec3 half = half_bounds(body_.shape);
  for (int k = -6; k <= 6; ++k) {
    for (int j = -6; j <= 6; ++j) {
      for (int i = -6; i <= 6; ++i) {
        const Vec3 x = body_.center + body_.world_from_shape * (Vec3(i, j, k) / 7.0).cwiseProduct(half);
        if (body_.level_at(x).value >= 0.0) continue;
        double depth = 1e300;
        for (const Vec3& v : mesh.vertices) depth = std::min(depth, (v - x).squaredNorm());
        EXPECT_LE(std::sqrt(depth), 1.01 * ball.radius);
      }
    }
  }
  EXPECT_LT(body_.level_at(ball.natural_center).value, 0.0);
}

/// Holes that are nearly closed stay open, thin rings stay whole.
TEST(Tori, OfExtremeRadiiKeepTheirGenus) {
  for (const std::string name : {"torus", "double-torus"}) {
    for (const auto& radius : {std::vector<double>{14.0, 10.0}, std::vector<double>{40.0, 10.0}}) {
      const Body body{make_shape(name, radius, 0.35, 1), Mat3::Identity(), Vec3::Zero()};
      const TriangleMesh mesh = mesh_of(body, 1.5 * mesh_cell(body.shape));
      const MeshTopology topology = topology_of(mesh);
      EXPECT_TRUE(topology.closed && topology.manifold && topology.oriented) << topology.first_fault;
      EXPECT_EQ(topology.components, 1);
      EXPECT_EQ(topology.genus, shape_genus(name)) << name << " " << radius[0];
      EXPECT_LE(std::abs(volume_of(mesh) / exact_volume(body.shape) - 1.0), 4e-3);
    }
  }
}

TEST(InnerBall, OfThinRingIsItsTube) {
  const Body ring{make_shape("torus", {40, 2.5}, 0.3, 1), Mat3::Identity(), Vec3(5, 0, 0)};
  const InnerBall ball = inner_ball(ring, mesh_of(ring, 0.6));
  EXPECT_NEAR(ball.radius, 2.5, 0.05);
  EXPECT_NEAR((ball.natural_center - Vec3(5, 0, 0)).norm(), 40.0, 0.05);
}

TEST(InnerBall, OfEllipsoidAndTubeIsKnown) {
  const Body ellipsoid{make_shape("ellipsoid", {30, 20, 10}, 0.3, 1), Mat3::Identity(), Vec3(1, 2, 3)};
  const InnerBall a = inner_ball(ellipsoid, mesh_of(ellipsoid, mesh_cell(ellipsoid.shape)));
  EXPECT_NEAR(a.radius, 10.0, 0.02);
  EXPECT_LE((a.natural_center - Vec3(1, 2, 3)).norm(), 0.02);
  const Body tube{make_shape("tube", {20}, 0.3, 1), Mat3::Identity(), Vec3::Zero()};
  const InnerBall b = inner_ball(tube, mesh_of(tube, mesh_cell(tube.shape)));
  EXPECT_NEAR(b.radius, 10.0, 0.03);
}

}  // namespace
}  // namespace pellicle
