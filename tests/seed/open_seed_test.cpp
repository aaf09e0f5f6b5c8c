// Start surfaces with a border: a bowl is filled up to its mouth, its lid taken off again.
#include "pellicle/seed/open_seed.h"

#include <gmock/gmock.h>

#include <numbers>

#include "pellicle/base/errors.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/mesh/points/rim.h"
#include "pellicle/raster/cup.h"
#include "pellicle/raster/rasterize.h"
#include "pellicle/seed/voxel_seed.h"

namespace pellicle {
namespace {

/// Points of a sphere of radius 10 between two heights, evenly spread.
std::vector<Vec3> zone(int of_sphere, double low, double high) {
  std::vector<Vec3> points;
  for (int k = 0; k < of_sphere; ++k) {
    const double z = 1.0 - 2.0 * (k + 0.5) / of_sphere, r = std::sqrt(1.0 - z * z), angle = 2.399963229728653 * k;
    if (z > low && z < high) points.emplace_back(10.0 * r * std::cos(angle), 10.0 * r * std::sin(angle), 10.0 * z);
  }
  return points;
}

QuadMesh start_on(const PointTree& tree) {
  const VoxelSeed seed = voxel_seed_of_mask(filled_cup(tree.points(), point_spacing(tree)), 4.0);
  return open_part(seed.mesh, {tree, plane_normals(tree)}, seed.spacing_mm);
}

TEST(FilledCup, EndsAtTheMouth) {
  const PointTree tree(zone(2500, 0.0, 2.0));
  const Image<std::uint8_t> cup = filled_cup(tree.points(), point_spacing(tree));
  const TriangleMesh filled = surface_of_mask(cup);
  const double voxel = cup.grid.spacing.x();
  const double half_ball = 2.0 / 3.0 * std::numbers::pi * 1000.0;
  EXPECT_TRUE(volume_of(filled) >= 0.95 * half_ball) << volume_of(filled);
  for (const Vec3& x : filled.vertices) {
    EXPECT_LE(x.norm(), 10.0 + 1.5 * voxel);
    EXPECT_GE(x.z(), -2.0 * voxel);
  }
}

TEST(FilledCup, ASheetEnclosesNothing) {
  std::vector<Vec3> sheet;
  for (int i = 0; i < 30; ++i) {
    for (int j = 0; j < 30; ++j) sheet.emplace_back(i, j, 1e-3 * i * j);
  }
  EXPECT_THROW(filled_cup(sheet, 1.0), BadData);
}

TEST(OpenPart, ABowlHasOneBorderAndATubeTwo) {
  struct Case {
    double low, high;
    int loops;
  };
  for (const Case& c : {Case{0.0, 2.0, 1}, Case{-0.6, 0.6, 2}}) {
    const PointTree tree(zone(2500, c.low, c.high));
    const QuadMesh mesh = start_on(tree);
    const QuadTopology topology = quad_topology(static_cast<int>(mesh.vertices.size()), mesh.quads, Border::allowed);
    EXPECT_EQ(topology.border_loops, c.loops);
    EXPECT_EQ(topology.genus, 0);
    EXPECT_EQ(topology.components, 1);
    for (const QuadRing& ring : topology.rings) {
      if (!ring.closed) {
        EXPECT_EQ(ring.quad.size(), 2U);  // no corners
      }
    }
    // No centre is further than a voxel of 4 mm; a quad's and the strip's corners are a width further.
    for (const Vec3& x : mesh.vertices) EXPECT_LE(tree.nearest(x, 1).front().distance, 2.5 * 4.0);
  }
}

TEST(OpenPartWithin, BordersLieEvenlyOnTheRims) {
  for (const auto& [low, high, rims] : {std::tuple(0.0, 2.0, 1U), std::tuple(-0.6, 0.6, 2U)}) {
    const PointTree tree(zone(2500, low, high));
    const OpenPoints points{tree, plane_normals(tree)};
    const Image<std::uint8_t> body = filled_cup(tree.points(), point_spacing(tree));
    const std::vector<RimCurve> curves = rims_of(body, points);
    ASSERT_EQ(curves.size(), rims);
    const VoxelSeed seed = voxel_seed_of_mask(body, 4.0);
    const QuadMesh mesh = open_part_within(seed.mesh, points, curves, seed.spacing_mm);
    std::vector<bool> on_border(mesh.vertices.size(), false);
    const auto loops = border_loops(split_quads(mesh).triangles);
    EXPECT_EQ(loops.size(), rims);
    for (const std::vector<int>& loop : loops) {
      double shortest = 1e9, longest = 0.0;
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const auto v = static_cast<std::size_t>(loop[i]), next = static_cast<std::size_t>(loop[(i + 1) % loop.size()]);
        on_border[v] = true;
        const double z = mesh.vertices[v].z();
        EXPECT_LE(std::min(std::abs(z - 10.0 * low), std::abs(z - 10.0 * high)), 0.5);  // points are 0.7 apart
        const double length = (mesh.vertices[v] - mesh.vertices[next]).norm();
        shortest = std::min(shortest, length);
        longest = std::max(longest, length);
      }
      EXPECT_LE(longest, 3.0 * shortest);
    }
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      EXPECT_NEAR(mesh.vertices[v].norm(), 10.0, 0.3);
      EXPECT_TRUE(on_border[v] || (mesh.vertices[v].z() > 10.0 * low && mesh.vertices[v].z() < 10.0 * high));
    }
  }
}

TEST(RimsOf, ClosedPointsHaveNone) {
  const PointTree tree(zone(2500, -2.0, 2.0));
  EXPECT_TRUE(rims_of(filled_cup(tree.points(), point_spacing(tree)), {tree, plane_normals(tree)}).empty());
}

TEST(OpenPart, NothingNearIsBadData) {
  const PointTree tree(zone(2500, 0.0, 2.0));
  const VoxelSeed seed = voxel_seed_of_mask(filled_cup(tree.points(), point_spacing(tree)), 4.0);
  EXPECT_THROW(open_part(seed.mesh, {tree, plane_normals(tree)}, 1e-6), BadData);
}

}  // namespace
}  // namespace pellicle
