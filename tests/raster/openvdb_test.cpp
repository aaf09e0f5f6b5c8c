// What OpenVDB's part in mask and distance is worth, and why partial volume does without it.
#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "../mesh/test_meshes.h"
#include "pellicle/mesh/distance.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/raster/rasterize.h"

namespace pellicle {
namespace {

ImageGrid oblique_grid(int size, const Vec3& spacing) {
  RandomEngine random(9);
  ImageGrid g;
  g.size = {size, size, size};
  g.spacing = spacing;
  g.direction = test::random_rotation(random);
  g.direction.col(1) *= -1.0;  // left-handed
  g.origin_in_world = {300, -200, 100};
  return g;
}

TEST(OpenVdb, MaskAgreesOnSmoothSolids) {
  const ImageGrid g = oblique_grid(64, {0.7, 0.8, 1.1});
  const Vec3 centre = g.world_from_index({31.3, 31.9, 31.6});
  for (const TriangleMesh& m :
       {test::sphere(5, 20, centre), test::torus(120, 60, 14, 5, centre), test::blob(5, 15, centre)}) {
    const MaskResult r = rasterize_mask_checked(m, g);
    EXPECT_TRUE(r.from_openvdb);
    ASSERT_TRUE(r.openvdb_volume_mm3.has_value());
    EXPECT_NEAR(*r.openvdb_volume_mm3 / r.exact_volume_mm3, 1.0, 0.005);
    EXPECT_NEAR(r.exact_volume_mm3 / r.mesh_volume_mm3, 1.0, 0.005);
    EXPECT_EQ(r.mesh_volume_mm3, volume_of(m));
    EXPECT_LE(static_cast<double>(r.corrected_voxels) * g.voxel_volume(), 0.005 * r.exact_volume_mm3);
    EXPECT_EQ(r.mask.voxels, rasterize_mask(m, g).voxels);
  }
}

TEST(OpenVdb, MaskIsRefusedWhereItIsWrong) {
  ImageGrid g;
  g.size = {48, 48, 48};
  const Vec3 c(23.4, 24.1, 23.8);
  const TriangleMesh ball = test::sphere(4, 20, c),
                     shell = test::together(ball, test::inside_out(test::sphere(4, 10, c)));
  const TriangleMesh reversed = test::inside_out(ball), wall = test::box({4.5, 4.5, 10.4}, {30.5, 30.5, 10.6});
  for (const TriangleMesh& m : {shell, reversed}) {
    const MaskResult r = rasterize_mask_checked(m, g);
    EXPECT_FALSE(r.from_openvdb);
    EXPECT_GT(r.openvdb_volume_mm3.value_or(0.0), r.exact_volume_mm3 + 1000.0);  // it fills whatever is enclosed
  }
  EXPECT_EQ(rasterize_mask_checked(wall, g).exact_volume_mm3, 0.0);
  // Hardly any of it is in the image: OpenVDB would fill the memory.
  const MaskResult around = rasterize_mask_checked(test::sphere(3, 1e7), g);
  EXPECT_FALSE(around.from_openvdb);
  EXPECT_FALSE(around.openvdb_volume_mm3.has_value());
  EXPECT_EQ(around.exact_volume_mm3, static_cast<double>(g.voxel_count()));
}

TEST(OpenVdb, DistanceIsTrueToATwentiethOfAVoxel) {
  for (const Vec3& spacing : {Vec3(0.8, 0.8, 0.8), Vec3(0.7, 0.8, 1.1), Vec3(0.5, 0.5, 1.5)}) {
    const ImageGrid g = oblique_grid(56, spacing);
    const TriangleMesh m = test::sphere(5, 16 * spacing.minCoeff(), g.world_from_index({27.3, 27.9, 27.6}));
    const double band = 4 * g.mean_spacing();
    const Image<float> distance = rasterize_signed_distance(m, g, band);
    const ClosestPoint closest(m);
    double sum = 0.0, worst = 0.0;
    std::size_t count = 0;
    for (int k = 0; k < g.size[2]; ++k) {
      for (int j = 0; j < g.size[1]; ++j) {
        for (int i = 0; i < g.size[0]; ++i) {
          const double d = closest.query(g.world_from_index(Vec3(i, j, k)), band).distance;
          const double error = std::abs(distance.at(i, j, k)) - std::min(d, band);
          worst = std::max(worst, std::abs(error));
          if (d >= band) continue;
          sum += error * error;
          ++count;
        }
      }
    }
    EXPECT_GT(count, 5000U);
    EXPECT_LE(std::sqrt(sum / static_cast<double>(count)), 0.05 * spacing.minCoeff());
    EXPECT_LE(worst, 0.25 * spacing.minCoeff());
  }
}

// Share of a unit cube below the plane at distance d (> 0: the cube's centre is outside) with normal n.
double share_below_plane(const openvdb::Vec3d& n, double d) {
  constexpr int kSteps = 16;
  double share = 0.0;
  for (int s = 0; s < kSteps * kSteps; ++s) {  // exact along the axis where n is largest
    int axis = 0;
    for (int a = 1; a < 3; ++a) axis = std::abs(n[a]) > std::abs(n[axis]) ? a : axis;
    const double u = (s % kSteps + 0.5) / kSteps - 0.5, v = (s / kSteps + 0.5) / kSteps - 0.5;
    const double top = (-d - n[(axis + 1) % 3] * u - n[(axis + 2) % 3] * v) / std::abs(n[axis]);
    share += std::clamp(top + 0.5, 0.0, 1.0);
  }
  return share / (kSteps * kSteps);
}

// Planes from OpenVDB's distance and gradient against the facets themselves: why partial volume is cut from facets.
TEST(OpenVdb, PlanesFromItsDistanceAreFarLessExactThanCutFacets) {
  ImageGrid g;
  g.size = {32, 32, 32};
  const TriangleMesh m = test::sphere(4, 10, {15.3, 15.8, 15.6});
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> facets;
  for (const Vec3& v : m.vertices) {
    points.emplace_back(static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()));
  }
  for (const auto& t : m.triangles) facets.emplace_back(t[0], t[1], t[2]);
  openvdb::initialize();
  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> adapter(points, facets);
  const auto level =
      openvdb::tools::meshToVolume<openvdb::FloatGrid>(adapter, *openvdb::math::Transform::createLinearTransform(1.0),
                                                       3.0F, 3.0F, openvdb::tools::DISABLE_RENORMALIZATION);
  const auto access = level->getConstAccessor();
  double planes = 0.0;
  for (int k = 0; k < 32; ++k) {
    for (int j = 0; j < 32; ++j) {
      for (int i = 0; i < 32; ++i) {
        const double d = static_cast<double>(access.getValue({i, j, k}));
        if (std::abs(d) > 0.9) {
          planes += d < 0.0 ? 1.0 : 0.0;
          continue;
        }
        openvdb::Vec3d n(access.getValue({i + 1, j, k}) - access.getValue({i - 1, j, k}),
                         access.getValue({i, j + 1, k}) - access.getValue({i, j - 1, k}),
                         access.getValue({i, j, k + 1}) - access.getValue({i, j, k - 1}));
        n.normalize();
        planes += share_below_plane(n, d);
      }
    }
  }
  const Image<float> cut = rasterize_partial_volume(m, g);
  const double exact = volume_of(m);
  const double cut_error = std::abs(std::accumulate(cut.voxels.begin(), cut.voxels.end(), 0.0) / exact - 1.0);
  const double plane_error = std::abs(planes / exact - 1.0);
  RecordProperty("plane_error", std::to_string(plane_error));
  EXPECT_LE(cut_error, 1e-6);
  EXPECT_GT(plane_error, 100 * cut_error);
}

}  // namespace
}  // namespace pellicle
