// The level set of OpenVDB as a second opinion on the mask: another method, by another hand.
#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>

#include "../mesh/test_meshes.h"
#include "pellicle/mesh/distance.h"
#include "pellicle/raster/rasterize.h"

namespace pellicle {
namespace {

openvdb::FloatGrid::Ptr level_set(const TriangleMesh& m, const ImageGrid& g) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> facets;
  for (const Vec3& v : m.vertices) {
    const Vec3 i = g.index_from_world(v);
    points.emplace_back(static_cast<float>(i.x()), static_cast<float>(i.y()), static_cast<float>(i.z()));
  }
  for (const auto& t : m.triangles) facets.emplace_back(t[0], t[1], t[2]);
  return openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(*openvdb::math::Transform::createLinearTransform(1.0),
                                                            points, facets, 2.0F);
}

struct Comparison {
  std::size_t inside = 0, differ = 0;
  double farthest = 0.0;  ///< voxel that differs from the surface, mm
};

Comparison compare(const TriangleMesh& m, const ImageGrid& g) {
  const auto grid = level_set(m, g);
  const auto access = grid->getConstAccessor();
  const Image<std::uint8_t> mask = rasterize_mask(m, g);
  const ClosestPoint closest(m);
  Comparison out;
  for (int k = 0; k < g.size[2]; ++k) {
    for (int j = 0; j < g.size[1]; ++j) {
      for (int i = 0; i < g.size[0]; ++i) {
        out.inside += mask.at(i, j, k);
        if ((access.getValue({i, j, k}) < 0.0F) == (mask.at(i, j, k) != 0)) continue;
        ++out.differ;
        out.farthest = std::max(out.farthest, closest.query(g.world_from_index(Vec3(i, j, k))).distance);
      }
    }
  }
  return out;
}

class OpenVdb : public testing::Test {
 protected:
  static void SetUpTestSuite() { openvdb::initialize(); }
};

TEST_F(OpenVdb, AgreesOnSmoothSolids) {
  RandomEngine random(9);
  ImageGrid g;
  g.size = {64, 64, 64};
  g.spacing = {0.7, 0.8, 1.1};
  g.direction = test::random_rotation(random);
  const Vec3 centre = g.world_from_index({31.3, 31.9, 31.6});
  for (const TriangleMesh& m :
       {test::sphere(5, 20, centre), test::torus(120, 60, 14, 5, centre), test::blob(5, 15, centre)}) {
    const Comparison c = compare(m, g);
    EXPECT_GT(c.inside, 10000U);
    // Its signs waver within a few hundredths of a voxel of a facet; the solid angle then sides with the mask.
    EXPECT_LE(c.differ, c.inside / 250);
    EXPECT_LE(c.farthest, 0.05);
  }
}

}  // namespace
}  // namespace pellicle
