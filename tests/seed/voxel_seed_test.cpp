// Start meshes from voxels: manifold whatever the voxels, of the object's genus, and surfaces that do not shrink.

#include "pellicle/seed/voxel_seed.h"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>

#include "pellicle/base/errors.h"
#include "pellicle/base/random.h"
#include "pellicle/mesh/distance.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/raster/rasterize.h"
#include "pellicle/seed/point_outline.h"
#include "pellicle/seed/seed_surface.h"
#include "pellicle/surface/surface.h"

namespace pellicle {
namespace {

Image<std::uint8_t> empty_voxels(int n) {
  ImageGrid grid;
  grid.size = {n, n, n};
  return Image<std::uint8_t>(grid);
}

MeshTopology health(const QuadMesh& mesh) {
  return topology_of(split_quads(mesh));
}

double voxel_volume(const Image<std::uint8_t>& voxels) {
  double count = 0;
  for (const auto v : voxels.voxels) count += v;
  return count * voxels.grid.voxel_volume();
}

TEST(VoxelBlock, AllPatternsAreClassedAsInTheReference) {
  std::ifstream file(std::string(PELLICLE_SOURCE_DIR) + "/tests/golden/any_topology.json");
  const std::string classes = nlohmann::json::parse(file).at("voxel").at("class");
  ASSERT_EQ(classes.size(), 256U);
  for (unsigned p = 0; p < 256; ++p) {
    const VoxelBlock block = classify_block(p);
    const char expected = block.kind == VoxelBlock::Kind::no_surface     ? '0'
                          : block.kind == VoxelBlock::Kind::edge_fault   ? 'e'
                          : block.kind == VoxelBlock::Kind::vertex_fault ? 'v'
                                                                         : char('0' + block.valence);
    EXPECT_EQ(expected, classes[p]) << p;
  }
}

TEST(MakeManifold, VoxelsThatTouchInAnEdgeOrACornerAreJoined) {
  for (const Index3& second : {Index3{2, 2, 1}, Index3{2, 2, 2}}) {
    Image<std::uint8_t> voxels = empty_voxels(5);
    voxels.at(1, 1, 1) = voxels.at(second[0], second[1], second[2]) = 1;
    voxels.at(1, 1, 2) = voxels.at(1, 2, 1) = 1;  // one part by faces
    if (second[2] == 2) voxels.at(1, 2, 2) = 0;
    const std::size_t filled = make_manifold(voxels);
    const MeshTopology t = health(boundary_of_voxels(voxels));
    EXPECT_TRUE(t.closed && t.manifold && t.oriented) << t.first_fault;
    EXPECT_EQ(t.components, 1);
    EXPECT_GE(filled + 1, 1U);
  }
}

TEST(MakeManifold, RandomVoxelsBecomeOneManifold) {
  RandomEngine random(17);
  for (int trial = 0; trial < 30; ++trial) {
    Image<std::uint8_t> voxels = empty_voxels(8);
    const double density = random.uniform(0.2, 0.7);
    for (auto& v : voxels.voxels) v = random.uniform() < density ? 1 : 0;
    const Image<std::uint8_t> before = voxels;
    make_manifold(voxels);
    const QuadMesh mesh = boundary_of_voxels(voxels);  // throws unless manifold
    const MeshTopology t = health(mesh);
    EXPECT_TRUE(t.closed && t.manifold && t.oriented) << t.first_fault;
    EXPECT_EQ(t.components, 1);
    EXPECT_NEAR(volume_of(split_quads(mesh)), voxel_volume(voxels), 1e-9);
    for (int a = 0; a < 3; ++a) EXPECT_LE(voxels.grid.size[std::size_t(a)], 10);
  }
}

TEST(MakeManifold, KeepsWhatIsManifoldAndFillsCavities) {
  Image<std::uint8_t> voxels = empty_voxels(9);
  for (int k = 2; k < 7; ++k) {
    for (int j = 2; j < 7; ++j) {
      for (int i = 2; i < 7; ++i) voxels.at(i, j, k) = 1;
    }
  }
  voxels.at(0, 0, 0) = 1;  // a speck apart
  voxels.at(4, 4, 4) = 0;  // a cavity
  EXPECT_EQ(make_manifold(voxels), 1U);
  EXPECT_EQ(voxel_volume(voxels), 125.0);
  EXPECT_EQ(voxels.grid.size, (Index3{7, 7, 7}));
  const QuadMesh mesh = boundary_of_voxels(voxels);
  EXPECT_EQ(mesh.quads.size(), 150U);
  EXPECT_NEAR(mesh.vertices[0].x(), 1.5, 1e-12);
  Image<std::uint8_t> none = empty_voxels(4);
  EXPECT_THROW(make_manifold(none), BadData);
}

/// Solids about the origin by formula, on an oblique grid of uneven voxels.
struct Solid {
  const char* name;
  int genus;
  double volume;
  std::function<bool(const Vec3&)> inside;
};

bool in_torus(const Vec3& x, double major, double minor) {
  return std::hypot(std::hypot(x.x(), x.y()) - major, x.z()) < minor;
}

Solid ball() {
  return {"ball", 0, 4.0 / 3 * std::numbers::pi * std::pow(15, 3), [](const Vec3& x) { return x.norm() < 15; }};
}
Solid ring() {
  return {"ring", 1, 2 * std::numbers::pi * std::numbers::pi * 17 * 36,
          [](const Vec3& x) { return in_torus(x, 17, 6); }};
}
Solid two_rings() {  // with a common tube between them
  return {"two rings", 2, 0.0,
          [](const Vec3& x) { return in_torus(x - Vec3(10, 0, 0), 11, 4) || in_torus(x + Vec3(10, 0, 0), 11, 4); }};
}
Solid rod() {
  return {"rod", 0, std::numbers::pi * 49 * 40,
          [](const Vec3& x) { return std::hypot(x.x(), x.y()) < 7 && std::abs(x.z()) < 20; }};
}

Image<std::uint8_t> mask_of(const Solid& solid) {
  ImageGrid grid;
  grid.size = {64, 64, 56};
  grid.spacing = Vec3(1, 1, 1.2);
  grid.direction = (Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized())).toRotationMatrix();
  grid.origin_in_world = -(grid.world_from_index_matrix() * Vec3(31.7, 31.2, 27.6));
  Image<std::uint8_t> mask(grid);
  for (int k = 0; k < grid.size[2]; ++k) {
    for (int j = 0; j < grid.size[1]; ++j) {
      for (int i = 0; i < grid.size[0]; ++i) {
        mask.at(i, j, k) = solid.inside(grid.world_from_index(Vec3(i, j, k))) ? 1 : 0;
      }
    }
  }
  return mask;
}

TEST(VoxelSeed, MasksGiveTheGenusOfTheObject) {
  for (const Solid& solid : {ball(), rod(), ring(), two_rings()}) {
    const Image<std::uint8_t> mask = mask_of(solid);
    const VoxelSeed seed = voxel_seed_of_mask(mask);
    EXPECT_EQ(seed.genus, solid.genus) << solid.name;
    const MeshTopology t = health(seed.mesh);
    EXPECT_TRUE(t.closed && t.manifold && t.oriented) << t.first_fault;
    EXPECT_EQ(t.genus, solid.genus) << solid.name;
    const double volume = volume_of(split_quads(seed.mesh));
    EXPECT_NEAR(volume / voxel_volume(mask), 1.0, 0.3) << solid.name;
  }
}

TEST(VoxelSeed, HandlesOfNoiseDoNotCount) {
  Image<std::uint8_t> mask = mask_of(ring());
  RandomEngine random(23);
  for (auto& v : mask.voxels) {
    if (random.uniform() < 0.05) v = v != 0 ? 0 : 1;  // pinholes and specks
  }
  EXPECT_EQ(voxel_seed_of_mask(mask, 4.0).genus, 1);
}

TEST(VoxelSeed, MirroredGridGivesAnOutwardMesh) {
  Image<std::uint8_t> mask = mask_of(rod());
  mask.grid.direction.col(0) *= -1;
  EXPECT_GT(volume_of(split_quads(voxel_seed_of_mask(mask).mesh)), 0.0);
}

TEST(VoxelSeed, ScatteredPointsOfASphereAndATorus) {
  RandomEngine random(31);
  std::vector<Vec3> sphere, torus;
  for (int i = 0; i < 8000; ++i) {
    sphere.emplace_back(Vec3(random.normal(), random.normal(), random.normal()).normalized() * 20 + Vec3(5, -3, 8));
    const double u = random.uniform(0, 2 * std::numbers::pi), v = random.uniform(0, 2 * std::numbers::pi);
    const double rho = 20 + 7 * std::cos(v);
    torus.emplace_back(rho * std::cos(u), rho * std::sin(u), 7 * std::sin(v));
  }
  EXPECT_NEAR(coarsest_spacing(sphere), 40.0 / 3, 0.2);
  const VoxelSeed ball = voxel_seed_of_points(sphere);
  EXPECT_EQ(ball.genus, 0);
  EXPECT_LE(ball.mesh.vertices.size(), 150U);
  EXPECT_LE((centroid_of(split_quads(ball.mesh)) - Vec3(5, -3, 8)).norm(), ball.spacing_mm);
  EXPECT_EQ(voxel_seed_of_points(torus, 3.5).genus, 1);
}

TEST(VoxelSeed, BadInputIsRefused) {
  EXPECT_THROW(voxel_seed_of_points({}), BadData);
  EXPECT_THROW(voxel_seed_of_points({Vec3(0, 0, 0), Vec3(1, 1, 0)}), BadData);
  EXPECT_THROW(voxel_seed_of_points({Vec3(0, 0, 0), Vec3(1, 1, 1)}, -1.0), UsageError);
  EXPECT_THROW(voxel_seed_of_points({Vec3(0, 0, 0), Vec3(1, 1, 1)}, 1e-9), UsageError);
  EXPECT_THROW(voxel_seed_of_mask(empty_voxels(5)), BadData);
}

TriangleMesh triangles_of(const SampleLayout& layout, const SurfaceSamples& samples) {
  return {samples.x, layout.triangles, samples.normal};
}

template <class Model>
TriangleMesh surface_of(const std::pair<Model, Parameters>& seed, int level) {
  const SampleLayout layout = seed.first.layout(level);
  SurfaceSamples samples;
  seed.first.evaluate(seed.second, layout, false, samples);
  return triangles_of(layout, samples);
}

TEST(SeedSurface, EveryModelKeepsSizeAndGenus) {
  for (const Solid& solid : {ball(), ring()}) {
    const Image<std::uint8_t> mask = mask_of(solid);
    const VoxelSeed seed = voxel_seed_of_mask(mask);
    const TriangleMesh truth = surface_of_mask(mask);
    const TriangleMesh catmull_clark = surface_of(catmull_clark_seed(seed.mesh), 2),
                       slime = surface_of(slime_seed(seed.mesh), 2), normal = surface_of(normal_seed(seed.mesh), 2);
    for (const TriangleMesh* surface : {&catmull_clark, &slime, &normal}) {
      EXPECT_EQ(topology_of(*surface).genus, solid.genus);
      EXPECT_NEAR(volume_of(*surface) / solid.volume, 1.0, 0.2);
      const SurfaceDistances d = surface_distances(*surface, truth, 1.0, 2000);
      EXPECT_LE(d.assd, 0.25 * seed.spacing_mm);
    }
  }
}

TEST(SeedSurface, CompensationBringsTheSurfaceToItsTargets) {
  const QuadMesh mesh = voxel_seed_of_mask(mask_of(rod())).mesh;
  const std::vector<Vec3> target = smoothed_vertices(mesh, 6);
  const PointRows limit = CatmullClarkModel(static_cast<int>(target.size()), mesh.quads, {}).limit_rows();
  const auto off = [&](const std::vector<Vec3>& c) {
    const std::vector<Vec3> x = limit.apply(c);
    double sum = 0;
    for (std::size_t v = 0; v < x.size(); ++v) sum += (x[v] - target[v]).squaredNorm();
    return std::sqrt(sum / static_cast<double>(x.size()));
  };
  EXPECT_LE(off(compensated(limit, target)), 0.1 * off(target));
}

/// Largest angle in degrees between facet and vertex normals.
double normal_error(const TriangleMesh& surface) {
  double worst = 1;
  for (const auto& t : surface.triangles) {
    const auto at = [&](int c) { return surface.vertices[std::size_t(t[std::size_t(c)])]; };
    const Vec3 facet = (at(1) - at(0)).cross(at(2) - at(0)).normalized();
    for (const int v : t) worst = std::min(worst, facet.dot(surface.normals[std::size_t(v)]));
  }
  return std::acos(worst) * 180 / std::numbers::pi;
}

TEST(SeedSurface, NormalSeedIsNormalContinuous) {
  const auto seed = normal_seed(voxel_seed_of_mask(mask_of(ring())).mesh);
  const double coarse = normal_error(surface_of(seed, 3)), fine = normal_error(surface_of(seed, 5));
  EXPECT_LE(fine, 0.55 * coarse);
  EXPECT_LE(fine, 25.0);
}

TEST(SeedSurface, SmoothingKeepsTheVolume) {
  const QuadMesh mesh = voxel_seed_of_mask(mask_of(ring())).mesh;
  const double before = volume_of(split_quads(mesh));
  EXPECT_NEAR(volume_of(split_quads({smoothed_vertices(mesh, 12), mesh.quads})) / before, 1.0, 0.03);
}

// A ball and a bent tube, whose outline must not fill the bend, and lies inside.
TEST(PointOutline, IsTheSolidThatThePointsLieOn) {
  RandomEngine random(11);
  std::vector<Vec3> ball, bow;
  for (int k = 0; k < 300; ++k) {
    ball.push_back(Vec3(4, -3, 2) + 12.0 * Vec3(random.normal(), random.normal(), random.normal()).normalized());
  }
  for (int k = 0; k < 500; ++k) {  // three quarters of a torus of radii 15 and 4, closed by its ends' discs
    const double u = random.uniform(0.0, 1.5 * std::numbers::pi), v = random.uniform(0.0, 2.0 * std::numbers::pi);
    const double w = k % 10 == 0 ? 4.0 * std::sqrt(random.uniform(0.0, 1.0)) : 4.0;
    const double at = k % 20 == 0 ? 0.0 : k % 10 == 0 ? 1.5 * std::numbers::pi : u;
    bow.emplace_back((15.0 + w * std::cos(v)) * std::cos(at), (15.0 + w * std::cos(v)) * std::sin(at), w * std::sin(v));
  }
  const auto volume = [](const Image<std::uint8_t>& mask) {
    return static_cast<double>(std::count(mask.voxels.begin(), mask.voxels.end(), 1)) * mask.grid.voxel_volume();
  };
  const double of_ball = 4.0 / 3.0 * std::numbers::pi * 1728.0;
  const double of_bow = 0.75 * 2.0 * std::pow(std::numbers::pi, 2) * 15.0 * 16.0;
  EXPECT_NEAR(volume(mask_of_points(ball)) / of_ball, 0.83, 0.12);
  EXPECT_NEAR(volume(mask_of_points(bow)) / of_bow, 0.7, 0.25);
}

TEST(PointOutline, RefusesWhatEnclosesNothing) {
  EXPECT_THROW(mask_of_points({Vec3::Zero(), Vec3::Ones(), Vec3::UnitX()}), BadData);
  EXPECT_THROW(mask_of_points(std::vector<Vec3>(20, Vec3(1, 2, 3))), BadData);
}

}  // namespace
}  // namespace pellicle
