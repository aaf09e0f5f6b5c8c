// Meshes and figures of many surfaces: what one object gets must not depend on the others.
#include "pellicle/job/measure.h"

#include <gtest/gtest.h>

#include "pellicle/job/label_map.h"
#include "pellicle/seed/seed_surface.h"
#include "pellicle/seed/voxel_seed.h"

namespace pellicle {
namespace {

/// The boundary of some voxels of 4 mm as a Catmull-Clark surface.
Surface surface_of(const std::vector<Index3>& filled) {
  ImageGrid grid;
  grid.size = {5, 5, 3};
  grid.spacing = {4, 4, 4};
  Image<std::uint8_t> voxels(grid);
  for (const Index3& v : filled) voxels.at(v[0], v[1], v[2]) = 1;
  make_manifold(voxels);
  auto [model, parameters] = catmull_clark_seed(boundary_of_voxels(voxels));
  return {std::move(model), std::move(parameters)};
}

TEST(Measure, SeedsWithEquallyManyPointsButOtherQuadsKeepTheirOwnMesh) {
  // Three voxels in a row and three around a corner: 16 control points and 14 quads each, joined in another way.
  const Surface row = surface_of({{1, 1, 1}, {2, 1, 1}, {3, 1, 1}}),
                corner = surface_of({{1, 1, 1}, {2, 1, 1}, {2, 2, 1}});
  ASSERT_EQ(control_point_count(row.model), control_point_count(corner.model));
  ASSERT_NE(control_mesh_of(row).triangles, control_mesh_of(corner).triangles);
  ImageGrid grid;
  grid.size = {30, 30, 20};
  SegmentOptions options{.many = true};
  std::vector<ObjectResult> together;
  for (const Surface& surface : {row, corner}) {
    ObjectResult object{.label = static_cast<int>(together.size()) + 1, .name = {}, .surface = surface};
    object.shape = ObjectShape{};
    together.push_back(object);
  }
  measure(together, grid, options);
  for (const ObjectResult& object : together) {
    const TriangleMesh own = tessellate(object.surface, object.mesh_level);
    EXPECT_EQ(object.mesh.triangles, own.triangles);
    EXPECT_EQ(object.mesh.vertices, own.vertices);
    EXPECT_TRUE(object.topology.closed && object.topology.manifold);
    EXPECT_EQ(object.self_intersections, 0U);
  }
}

TEST(Measure, OneObjectAndManyAgreeOnTheVolume) {
  const NormalModel model = NormalModel::start(StartSolid::icosahedron, SubdivisionRule::smooth);
  const Surface ball{model, affine_image(model, Vec3(15, 15, 10), 6.0 * Mat3::Identity())};
  ImageGrid grid;
  grid.size = {30, 30, 20};
  std::vector<ObjectResult> one{{.name = {}, .surface = ball}}, many = one;
  many.front().shape = ObjectShape{};
  measure(one, grid, {});
  measure(many, grid, {.many = true});
  const VoxelMaps of_one = label_map(one, grid, {}), of_many = label_map(many, grid, {.many = true});
  EXPECT_NEAR(one.front().volume_surface_ml, many.front().volume_surface_ml, 1e-3 * one.front().volume_surface_ml);
  EXPECT_NEAR(one.front().volume_mask_ml, many.front().volume_mask_ml, 0.02 * one.front().volume_mask_ml);
  EXPECT_LE(many.front().mesh.triangles.size(), one.front().mesh.triangles.size());
}

}  // namespace
}  // namespace pellicle
