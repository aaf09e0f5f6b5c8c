// Quad meshes: what they are made of, every way to be broken, and Catmull-Clark against an independent implementation.

#include "pellicle/mesh/quad/quad_mesh.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "pellicle/base/errors.h"
#include "pellicle/base/random.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/mesh/quad/quad_subdivision.h"

namespace pellicle {
namespace {

using testing::HasSubstr;

nlohmann::json golden() {
  std::ifstream file(std::string(PELLICLE_SOURCE_DIR) + "/tests/golden/any_topology.json");
  return nlohmann::json::parse(file).at("catmull_clark");
}

Vec3 vec(const nlohmann::json& j) {
  return {j.at(0).get<double>(), j.at(1).get<double>(), j.at(2).get<double>()};
}

QuadMesh mesh_of(const nlohmann::json& j) {
  QuadMesh mesh;
  for (const auto& p : j.at("P")) mesh.vertices.push_back(vec(p));
  mesh.quads = j.at("F").get<std::vector<Quad>>();
  return mesh;
}

QuadTopology topology(const QuadMesh& mesh, Border border = Border::refused) {
  return quad_topology(static_cast<int>(mesh.vertices.size()), mesh.quads, border);
}

/// A strip of quads, `width` x `height`, in the plane z = 0.
QuadMesh sheet(int width, int height) {
  QuadMesh mesh;
  for (int j = 0; j <= height; ++j) {
    for (int i = 0; i <= width; ++i) mesh.vertices.emplace_back(i, j, 0);
  }
  const auto at = [&](int i, int j) { return j * (width + 1) + i; };
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) mesh.quads.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
  }
  return mesh;
}

std::string fault(int vertices, const std::vector<Quad>& quads, Border border = Border::refused) {
  try {
    quad_topology(vertices, quads, border);
  } catch (const BadData& e) {
    return e.what();
  }
  return "";
}

TEST(QuadMesh, CubeAndTorusAreClosedOutwardAndOfTheirGenus) {
  const QuadTopology cube = topology(cube_mesh());
  EXPECT_EQ(cube.edges.size(), 12U);
  EXPECT_EQ(cube.euler, 2);
  EXPECT_EQ(cube.genus, 0);
  EXPECT_TRUE(cube.closed());
  for (const QuadRing& ring : cube.rings) EXPECT_EQ(ring.valence(), 3);
  EXPECT_NEAR(volume_of(split_quads(cube_mesh())), 8 / std::pow(3, 1.5), 1e-14);
  const QuadMesh ring = torus_mesh(5, 3, 2, 0.7);
  EXPECT_EQ(topology(ring).euler, 0);
  EXPECT_EQ(topology(ring).genus, 1);
  EXPECT_GT(volume_of(split_quads(ring)), 0.0);
}

TEST(QuadMesh, RingsRunCounterClockwiseSeenFromOutside) {
  const QuadMesh mesh = cube_mesh();
  const QuadTopology t = topology(mesh);
  for (int v = 0; v < t.vertex_count(); ++v) {
    const QuadRing& ring = t.rings[std::size_t(v)];
    for (std::size_t i = 0; i < 3; ++i) {
      const auto e = [&](std::size_t k) { return mesh.vertices[std::size_t(ring.edge[k % 3])]; };
      EXPECT_GT(e(i).cross(e(i + 1)).dot(mesh.vertices[std::size_t(v)]), 0.0);
      const Quad& q = t.quads[std::size_t(ring.quad[i])];
      for (const int w : {v, ring.edge[i], ring.diagonal[i], ring.edge[(i + 1) % 3]})
        EXPECT_THAT(q, testing::Contains(w));
    }
  }
}

TEST(QuadMesh, BordersOnRequestOnly) {
  const QuadMesh flat = sheet(3, 2);
  EXPECT_THAT(fault(12, flat.quads), HasSubstr("open"));
  const QuadTopology t = topology(flat, Border::allowed);
  EXPECT_EQ(t.border_loops, 1);
  EXPECT_EQ(t.genus, 0);
  EXPECT_EQ(t.rings[0].valence(), 2);  // corner
  EXPECT_FALSE(t.rings[0].closed);
  EXPECT_EQ(t.rings[0].edge, (std::vector{1, 4}));  // from border to border, the quad on the left
  EXPECT_EQ(t.rings[1].edge, (std::vector{2, 5, 0}));
  EXPECT_TRUE(t.rings[5].closed);
}

TEST(QuadMesh, EveryFaultIsNamed) {
  const std::vector<Quad> cube = cube_mesh().quads;
  const auto changed = [&](std::size_t f, const Quad& quad) {
    std::vector<Quad> quads = cube;
    quads[f] = quad;
    return quads;
  };
  EXPECT_THAT(fault(0, {}), HasSubstr("no quads"));
  EXPECT_THAT(fault(8, changed(2, {0, 1, 8, 4})), HasSubstr("quad 2"));
  EXPECT_THAT(fault(8, changed(3, {2, 6, 2, 3})), HasSubstr("twice"));
  EXPECT_THAT(fault(9, cube), HasSubstr("vertex 8"));
  EXPECT_THAT(fault(8, changed(0, {0, 1, 3, 2})), HasSubstr("turn some of the quads round"));
}

TEST(QuadMesh, SheetsThatTouchAndOneSidedSurfacesAreTold) {
  std::vector<Quad> more = cube_mesh().quads;
  more.push_back({0, 1, 8, 9});
  EXPECT_THAT(fault(10, more), HasSubstr("edge 0-1): has 3 quads"));
  // two cubes with a common corner
  std::vector<Quad> two = cube_mesh().quads;
  for (const Quad& q : cube_mesh().quads) {
    Quad moved = q;
    for (int& v : moved) v = v == 0 ? 0 : v + 7;
    two.push_back(moved);
  }
  EXPECT_THAT(fault(15, two), HasSubstr("two sheets touch"));
  // Moebius band of five quads
  std::vector<Quad> band;
  for (int i = 0; i < 4; ++i) band.push_back({2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1});
  band.push_back({8, 1, 0, 9});
  EXPECT_THAT(fault(10, band, Border::allowed), HasSubstr("only one side"));
  // a pillow: two quads with a common border
  EXPECT_THAT(fault(4, {{0, 1, 2, 3}, {3, 2, 1, 0}}), HasSubstr("two quads only"));
}

TEST(QuadMesh, SplitFollowsNormalsOrTheShorterDiagonal) {
  QuadMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {3, 3, 0}, {0, 1, 0}};
  mesh.quads = {{0, 1, 2, 3}};
  EXPECT_EQ(split_quads(mesh).triangles[0], (std::array{0, 1, 3}));
  const Vec3 up(0, 0, 1), side(1, 0, 0);
  const TriangleMesh split = split_quads(mesh, {up, side, up, up});
  EXPECT_EQ(split.triangles[0], (std::array{0, 1, 2}));
  EXPECT_EQ(split.normals.size(), 4U);
}

TEST(CatmullClark, LimitMasksAgreeWithTheReferenceImplementation) {
  const nlohmann::json j = golden();
  const QuadMesh mesh = mesh_of(j);
  const QuadTopology t = topology(mesh);
  const LimitMasks masks = catmull_clark_limit(t);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    EXPECT_EQ(t.rings[v].valence(), j.at("valence").at(v).get<int>());
    EXPECT_LE((masks.position.apply(v, mesh.vertices) - vec(j.at("limit_positions").at(v))).norm(), 1e-12);
    const Vec3 normal = masks.tangent_u.apply(v, mesh.vertices).cross(masks.tangent_v.apply(v, mesh.vertices));
    EXPECT_LE((normal.normalized() - vec(j.at("limit_normals").at(v))).norm(), 1e-11);
  }
}

// The step and the limit check each other: the limit of a refined vertex is the limit of the vertex.
TEST(CatmullClark, StepKeepsTheLimitOpenAndClosed) {
  RandomEngine random(4);
  QuadMesh flat = sheet(4, 3);
  for (Vec3& x : flat.vertices) x.z() = random.uniform(-1, 1);
  for (const QuadMesh& mesh : {mesh_of(golden()), torus_mesh(4, 3, 2, 0.7), flat}) {
    const QuadTopology t = topology(mesh, Border::allowed);
    const QuadStep step = catmull_clark_step(t);
    EXPECT_EQ(step.quads.size(), 4 * mesh.quads.size());
    const std::vector<Vec3> fine = step.rows.apply(mesh.vertices);
    const QuadTopology u = quad_topology(static_cast<int>(fine.size()), step.quads, Border::allowed);
    EXPECT_EQ(u.euler, t.euler);
    const LimitMasks coarse_limit = catmull_clark_limit(t), fine_limit = catmull_clark_limit(u);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      EXPECT_LE((coarse_limit.position.apply(v, mesh.vertices) - fine_limit.position.apply(v, fine)).norm(), 1e-14);
      if (!t.rings[v].closed) continue;
      const auto normal = [&](const LimitMasks& m, const std::vector<Vec3>& x) -> Vec3 {
        return m.tangent_u.apply(v, x).cross(m.tangent_v.apply(v, x)).normalized();
      };
      EXPECT_LE((normal(coarse_limit, mesh.vertices) - normal(fine_limit, fine)).norm(), 1e-12);
    }
  }
}

TEST(CatmullClark, RowsSumToOne) {
  const QuadTopology t = topology(sheet(3, 3), Border::allowed);
  const std::vector<Vec3> ones(std::size_t(t.vertex_count()), Vec3::Ones());
  for (const Vec3& x : catmull_clark_step(t).rows.apply(ones)) EXPECT_LE((x - Vec3::Ones()).norm(), 1e-15);
  for (const Vec3& x : catmull_clark_limit(t).position.apply(ones)) EXPECT_LE((x - Vec3::Ones()).norm(), 1e-15);
}

}  // namespace
}  // namespace pellicle
