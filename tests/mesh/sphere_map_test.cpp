// Spherical maps are one to one, whatever the shape, and know nothing of where the surface lies.
#include "pellicle/mesh/sphere/sphere_map.h"

#include <gmock/gmock.h>

#include <numbers>

#include "pellicle/base/errors.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/mesh/sphere/internal/collapse.h"
#include "test_meshes.h"

namespace pellicle {
namespace {

/// A ball with four long limbs.
TriangleMesh starfish(int level) {
  return test::moved(test::sphere(level, 1.0), [](const Vec3& n) -> Vec3 {
    double r = 1.0;
    for (const Vec3& limb : {Vec3(1, 0, 0), Vec3(-1, 0.3, 0), Vec3(0, 1, 0.4), Vec3(0, -0.8, 0.7)}) {
      r += 3.0 * std::exp(-25.0 * (n - limb.normalized()).squaredNorm());
    }
    return r * n;
  });
}

void expect_bijection(const SphereMap& map) {
  ASSERT_EQ(map.direction.size(), map.mesh.vertices.size());
  double total = 0.0;
  for (const auto& t : map.mesh.triangles) {
    const double area =
        spherical_area(map.direction[static_cast<std::size_t>(t[0])], map.direction[static_cast<std::size_t>(t[1])],
                       map.direction[static_cast<std::size_t>(t[2])]);
    EXPECT_TRUE(area > 0.0);
    total += area;
  }
  EXPECT_NEAR(total, 4.0 * std::numbers::pi, 1e-9);  // covered once
  const MeshTopology topology = topology_of(map.mesh);
  EXPECT_TRUE(topology.closed && topology.manifold && topology.oriented) << topology.first_fault;
  EXPECT_EQ(topology.genus, 0);
}

TEST(SphereMap, IsOneToOne) {
  expect_bijection(map_to_sphere(test::blob(3, 20.0, Vec3(5, -3, 80))));
  expect_bijection(map_to_sphere(starfish(4)));
  expect_bijection(map_to_sphere(test::box(Vec3(0, 0, 0), Vec3(1, 2, 30))));
}

TEST(SphereMap, OfASphereIsNearlyAnIsometry) {
  const SphereMap map = map_to_sphere(test::sphere(4, 7.0));
  EXPECT_TRUE(map.stretch >= 1.0 - 1e-3);
  EXPECT_TRUE(map.stretch <= 1.02) << map.stretch;
}

TEST(SphereMap, LimbsGetTheirShare) {
  const SphereMap map = map_to_sphere(starfish(4));
  EXPECT_TRUE(map.stretch <= 3.0) << map.stretch;  // the conformal map of such limbs is worse by orders of magnitude
}

TEST(SphereMap, KnowsNoPlaceAndNoSize) {
  const TriangleMesh shape = starfish(3);
  const SphereMap here = map_to_sphere(shape);
  const SphereMap there = map_to_sphere(test::moved(shape, [](const Vec3& x) -> Vec3 { return 8.0 * x; }));
  EXPECT_NEAR(here.stretch, there.stretch, 1e-6 * here.stretch);
}

TEST(SphereMap, SimplifiesToAsManyVerticesAsAllowed) {
  SphereMapSettings settings;
  settings.max_vertices = 300;
  const TriangleMesh shape = test::blob(4, 10.0, Vec3::Zero());
  const SphereMap map = map_to_sphere(shape, settings);
  EXPECT_EQ(map.mesh.vertices.size(), 300U);
  expect_bijection(map);
  EXPECT_NEAR(volume_of(map.mesh) / volume_of(shape), 1.0, 0.03);
}

TEST(SphereMap, RefusesWhatIsNoSphere) {
  EXPECT_THROW(map_to_sphere(test::torus(20, 10, 10.0, 3.0)), BadData);
  EXPECT_THROW(map_to_sphere(test::together(test::sphere(1, 1.0), test::sphere(1, 1.0, Vec3(9, 0, 0)))), BadData);
  TriangleMesh open = test::sphere(2, 1.0);
  open.triangles.pop_back();
  EXPECT_THROW(map_to_sphere(open), BadData);
}

TEST(SphereLocator, FindsEveryPlaceWithAndWithoutAHint) {
  const SphereMap map = map_to_sphere(starfish(3));
  const SphereLocator locator(map);
  RandomEngine random(5);
  for (int i = 0; i < 500; ++i) {
    const auto t = static_cast<std::size_t>(random.next() % map.mesh.triangles.size());
    Vec3 w(random.uniform(), random.uniform(), random.uniform());
    w /= w.sum();
    Vec3 direction = Vec3::Zero(), expected = Vec3::Zero();
    for (std::size_t c = 0; c < 3; ++c) {
      const auto v = static_cast<std::size_t>(map.mesh.triangles[t][c]);
      direction += w[static_cast<int>(c)] * map.direction[v];
      expected += w[static_cast<int>(c)] * map.mesh.vertices[v];
    }
    const auto place =
        locator.locate(direction, i % 2 == 0 ? -1 : static_cast<int>(random.next() % map.mesh.triangles.size()));
    EXPECT_LE((locator.point_at(place) - expected).norm(), 1e-9);
  }
}

TEST(CollapsedMesh, PutTogetherAgainIsTheMeshItself) {
  const TriangleMesh shape = test::blob(2, 3.0, Vec3::Zero());
  CollapsedMesh collapsed(shape);
  EXPECT_EQ(collapsed.vertex_count(), 4);
  while (!collapsed.is_whole()) collapsed.split();
  EXPECT_EQ(collapsed.vertex_count(), static_cast<int>(shape.vertices.size()));
  for (int t = 0; t < collapsed.all_triangles(); ++t) {
    EXPECT_TRUE(collapsed.has_triangle(t));
    EXPECT_EQ(collapsed.triangle(t), shape.triangles[static_cast<std::size_t>(t)]);
  }
}

}  // namespace
}  // namespace pellicle
