#include <gmock/gmock.h>

#include <algorithm>

#include "../mesh/test_meshes.h"
#include "pellicle/mesh/distance.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/raster/rasterize.h"

namespace pellicle {
namespace {

ImageGrid grid_of(int nx, int ny, int nz) {
  ImageGrid g;
  g.size = {nx, ny, nz};
  return g;
}

// Euler characteristic of the solid in which voxels hold together by faces, and the outside by faces and edges: voxels
// - faces + edges - corners, each counted when all voxels round it are inside, and one more where around a corner only
// two opposite voxels are outside: they do not see each other through it, so the ring of the other six is filled. The
// surface has twice that.
int euler_of_solid(const Image<std::uint8_t>& mask) {
  const Index3& n = mask.grid.size;
  int euler = 0;
  for (int k = 0; k < n[2]; ++k) {
    for (int j = 0; j < n[1]; ++j) {
      for (int i = 0; i < n[0]; ++i) {
        for (int c = 0; c < 4 && i + 1 < n[0] && j + 1 < n[1] && k + 1 < n[2]; ++c) {  // corner c and 7 - c outside
          int inside = 0;
          for (int d = 0; d < 8; ++d)
            inside |= (mask.at(i + (d & 1), j + (d >> 1 & 1), k + (d >> 2)) != 0 ? 1 : 0) << d;
          if (inside == (255 & ~(1 << c) & ~(1 << (7 - c)))) ++euler;
        }
        for (int block = 0; block < 8; ++block) {  // the block of voxels that reaches one on along the axes in `block`
          bool all = true;
          for (int c = 0; c < 8; ++c) {
            if ((c & ~block) != 0) continue;
            const int a = i + (c & 1), b = j + (c >> 1 & 1), d = k + (c >> 2);
            all = all && a < n[0] && b < n[1] && d < n[2] && mask.at(a, b, d) != 0;
          }
          if (all) euler += (block == 0 || block == 3 || block == 5 || block == 6) ? 1 : -1;
        }
      }
    }
  }
  return euler;
}

void expect_proper(const TriangleMesh& m) {
  const MeshTopology t = topology_of(m);
  ASSERT_TRUE(t.closed && t.manifold && t.oriented) << t.first_fault;
}

TEST(SurfaceOfMask, RandomMasksGiveClosedManifoldsOfTheRightTopology) {
  RandomEngine random(1);
  for (int trial = 0; trial < 300; ++trial) {
    Image<std::uint8_t> mask(grid_of(2 + trial % 6, 2 + trial % 5, 2 + trial % 7));
    const double share = random.uniform(0.05, 0.95);
    for (auto& v : mask.voxels) v = random.uniform() < share ? 1 : 0;
    if (std::count(mask.voxels.begin(), mask.voxels.end(), 1) == 0) continue;
    const TriangleMesh m = surface_of_mask(mask);
    expect_proper(m);
    EXPECT_EQ(topology_of(m).euler, 2 * euler_of_solid(mask));
    EXPECT_GT(volume_of(m), 0.0);
    // The centres of the voxels are on their own side of it: rasterising gives the mask back.
    EXPECT_EQ(rasterize_mask(m, mask.grid).voxels, mask.voxels);
    EXPECT_EQ(self_intersection_count(m), 0U);
  }
}

TEST(SurfaceOfMask, AmbiguousNeighbours) {
  Image<std::uint8_t> mask(grid_of(4, 4, 4));
  mask.at(1, 1, 1) = mask.at(2, 2, 1) = 1;  // an edge in common
  EXPECT_EQ(topology_of(surface_of_mask(mask)).components, 2);
  mask.at(2, 2, 1) = 0;
  mask.at(2, 2, 2) = 1;  // a corner in common
  EXPECT_EQ(topology_of(surface_of_mask(mask)).components, 2);
  mask.at(2, 1, 1) = mask.at(2, 2, 1) = 1;
  EXPECT_EQ(topology_of(surface_of_mask(mask)).components, 1);
  EXPECT_TRUE(surface_of_mask(Image<std::uint8_t>(grid_of(3, 3, 3))).triangles.empty());
  EXPECT_NEAR(volume_of(surface_of_mask(Image<std::uint8_t>(grid_of(5, 6, 7), 1))), 210.0,
              21.0);  // closed at the border; edges are rounded
}

TEST(SurfaceOfMask, GenusOfATorusAndOrientationOnAnyGrid) {
  RandomEngine random(2);
  for (int trial = 0; trial < 6; ++trial) {
    ImageGrid g = grid_of(60, 60, 40);
    g.spacing = {0.5, 0.6, 0.9};
    g.direction = test::random_rotation(random);
    if (trial % 2 == 0) g.direction.col(0) *= -1.0;
    g.origin_in_world = {100, 200, 300};
    const TriangleMesh torus = test::torus(60, 30, 9, 3, g.world_from_index({29.6, 29.4, 19.7}));
    const TriangleMesh m = surface_of_mask(rasterize_mask(torus, g));
    expect_proper(m);
    EXPECT_EQ(topology_of(m).genus, 1);
    EXPECT_NEAR(volume_of(m) / volume_of(torus), 1.0, 0.03);
    const SurfaceDistances d = surface_distances(m, torus, 0.5);
    EXPECT_LE(d.assd, 0.15 * g.mean_spacing());
  }
}

// Mirroring the voxels mirrors the surface: no direction is preferred.
TEST(SurfaceOfMask, MirrorImagesMeasureTheSame) {
  RandomEngine random(3);
  Image<std::uint8_t> mask(grid_of(9, 9, 9)), mirrored(mask.grid);
  for (auto& v : mask.voxels) v = random.uniform() < 0.4 ? 1 : 0;
  for (int k = 0; k < 9; ++k) {
    for (int j = 0; j < 9; ++j) {
      for (int i = 0; i < 9; ++i) mirrored.at(8 - i, k, j) = mask.at(i, j, k);
    }
  }
  const TriangleMesh a = surface_of_mask(mask), b = surface_of_mask(mirrored);
  EXPECT_EQ(topology_of(a).euler, topology_of(b).euler);
  // Quads have two diagonals, so the two agree only nearly.
  EXPECT_NEAR(volume_of(a) / volume_of(b), 1.0, 1e-3);
  EXPECT_NEAR(area_of(a) / area_of(b), 1.0, 1e-2);
}

TEST(SurfaceOfMask, ASphereIsMetToATenthOfAVoxel) {
  for (const double radius : {5.0, 10.0, 20.0}) {
    const TriangleMesh sphere = test::sphere(5, radius, {24.3, 23.9, 24.4});
    const TriangleMesh m = surface_of_mask(rasterize_mask(sphere, grid_of(48, 48, 48)));
    expect_proper(m);
    const SurfaceDistances d = surface_distances(m, sphere, 1.0);
    EXPECT_LE(d.assd, 0.12);
    EXPECT_LE(d.hd, 0.6);
    EXPECT_NEAR(volume_of(m) / volume_of(sphere), 1.0, 0.4 / radius);
  }
}

}  // namespace
}  // namespace pellicle
