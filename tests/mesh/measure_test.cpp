#include "pellicle/mesh/measure.h"

#include <gmock/gmock.h>

#include "pellicle/base/errors.h"
#include "test_meshes.h"

namespace pellicle {
namespace {

using testing::HasSubstr;

TEST(Measure, BoxFarFromTheOrigin) {
  const Vec3 far(1e5, -2e5, 3e5);
  const TriangleMesh m = test::box(far, far + Vec3(2, 3, 5));
  EXPECT_NEAR(volume_of(m), 30.0, 1e-9);
  EXPECT_NEAR(area_of(m), 62.0, 1e-9);
  EXPECT_LE((centroid_of(m) - (far + Vec3(1, 1.5, 2.5))).norm(), 1e-9);
  EXPECT_NEAR(volume_of(test::inside_out(m)), -30.0, 1e-9);
}

TEST(Measure, VolumeAndCentroidFollowAnAffineMap) {
  RandomEngine random(7);
  const TriangleMesh m = test::blob(3, 10, {3, -2, 5});
  Mat3 a;
  for (int i = 0; i < 9; ++i) a(i / 3, i % 3) = random.normal();
  const Vec3 shift(100, -50, 20);
  const TriangleMesh n = test::moved(m, [&](const Vec3& x) -> Vec3 { return a * x + shift; });
  EXPECT_NEAR(volume_of(n) / (a.determinant() * volume_of(m)), 1.0, 1e-11);
  EXPECT_LE((centroid_of(n) - (a * centroid_of(m) + shift)).norm(), 1e-10);
}

// models.md 1.7: the flat volume converges with order 2, the one with normals with order 4, to these very figures.
TEST(Measure, VolumeWithNormalsIsOfFourthOrder) {
  const double exact = 4.0 / 3.0 * std::numbers::pi;
  const auto flat = [&](int level) { return volume_of(test::sphere(level, 1.0)) / exact - 1.0; };
  const auto curved = [&](int level) { return volume_with_normals(test::sphere(level, 1.0)) / exact - 1.0; };
  EXPECT_NEAR(flat(2), -3.4e-2, 0.05e-2);
  EXPECT_NEAR(flat(3), -8.6e-3, 0.05e-3);
  EXPECT_NEAR(curved(2), -4.5e-4, 0.05e-4);
  EXPECT_NEAR(curved(3), -2.9e-5, 0.05e-5);
  for (int level = 2; level < 5; ++level) {
    EXPECT_NEAR(std::log2(flat(level) / flat(level + 1)), 2.0, 0.1);
    EXPECT_NEAR(std::log2(curved(level) / curved(level + 1)), 4.0, 0.1);
  }
  EXPECT_THROW(volume_with_normals(test::box({0, 0, 0}, {1, 1, 1})), BadData);
}

TEST(Topology, KnownSurfaces) {
  const auto check = [](const TriangleMesh& m, int components, int genus) {
    const MeshTopology t = topology_of(m);
    EXPECT_TRUE(t.closed && t.manifold && t.oriented) << t.first_fault;
    EXPECT_EQ(t.components, components);
    EXPECT_EQ(t.genus, genus);
    EXPECT_EQ(t.first_fault, "");
  };
  check(test::sphere(2, 1), 1, 0);
  check(test::torus(12, 8, 3, 1), 1, 1);
  check(test::together(test::torus(12, 8, 3, 1), test::torus(9, 7, 3, 1, {0, 0, 9})), 2, 2);
  check(test::together(test::sphere(1, 1), test::torus(12, 8, 3, 1)), 2, 1);
}

TEST(Topology, BorderLoopsAreThoughtClosed) {
  TriangleMesh torus = test::torus(12, 8, 3, 1);
  torus.triangles.pop_back();
  torus.triangles.erase(torus.triangles.begin() + 50);
  EXPECT_EQ(topology_of(torus).border_loops, 2);
  EXPECT_EQ(topology_of(torus).genus, 1);
  EXPECT_EQ(topology_of(test::sphere(1, 1)).border_loops, 0);
}

TEST(Topology, NamesTheFirstFault) {
  TriangleMesh open = test::sphere(1, 1);
  open.triangles.pop_back();
  EXPECT_FALSE(topology_of(open).closed);
  EXPECT_THAT(topology_of(open).first_fault, HasSubstr("is open"));

  TriangleMesh turned = test::sphere(1, 1);
  std::swap(turned.triangles[5][0], turned.triangles[5][1]);
  EXPECT_TRUE(topology_of(turned).closed && topology_of(turned).manifold);
  EXPECT_FALSE(topology_of(turned).oriented);

  // Two boxes along one edge; two tetrahedra at one vertex.
  TriangleMesh book = test::together(test::box({0, 0, 0}, {1, 1, 1}), test::box({1, 1, 0}, {2, 2, 1}));
  for (auto& t : book.triangles) {
    for (int& i : t) i = i == 8 ? 3 : i == 12 ? 7 : i;
  }
  EXPECT_FALSE(topology_of(book).manifold);
  EXPECT_THAT(topology_of(book).first_fault, HasSubstr("edge 3-7 has 4 facets"));
  TriangleMesh tips = test::together(test::sphere(0, 1), test::sphere(0, 1, {5, 0, 0}));
  for (auto& t : tips.triangles) {
    for (int& i : t) i = i == 12 ? 3 : i;
  }
  EXPECT_TRUE(topology_of(tips).closed);
  EXPECT_FALSE(topology_of(tips).manifold);
  EXPECT_THAT(topology_of(tips).first_fault, HasSubstr("vertex 3"));

  TriangleMesh wild = test::sphere(0, 1);
  wild.triangles[3][1] = 99;
  EXPECT_THROW(topology_of(wild), BadData);
  EXPECT_THROW(self_intersection_count(wild), BadData);
}

// Exact oracle on whole numbers: the separating axis theorem for two triangles (no axis separates them strictly).
using Int3 = std::array<long, 3>;
Int3 minus(const Int3& a, const Int3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Int3 cross(const Int3& a, const Int3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
long dot(const Int3& a, const Int3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

bool meet(const std::array<Int3, 3>& a, const std::array<Int3, 3>& b) {
  std::vector<Int3> axes;
  const Int3 na = cross(minus(a[1], a[0]), minus(a[2], a[0])), nb = cross(minus(b[1], b[0]), minus(b[2], b[0]));
  axes = {na, nb};
  for (std::size_t i = 0; i < 3; ++i) {
    const Int3 ea = minus(a[(i + 1) % 3], a[i]), eb = minus(b[(i + 1) % 3], b[i]);
    axes.push_back(cross(na, ea));
    axes.push_back(cross(nb, eb));
    for (std::size_t j = 0; j < 3; ++j) axes.push_back(cross(ea, minus(b[(j + 1) % 3], b[j])));
  }
  for (const Int3& axis : axes) {
    const auto range = [&](const std::array<Int3, 3>& t) {
      return std::minmax({dot(axis, t[0]), dot(axis, t[1]), dot(axis, t[2])});
    };
    const auto [a0, a1] = range(a);
    const auto [b0, b1] = range(b);
    if (a1 < b0 || b1 < a0) return false;
  }
  return true;
}

// Small whole numbers make contacts, coplanar pairs and points on edges common.
TEST(SelfIntersection, AgreesWithAnExactOracleOnSoups) {
  RandomEngine random(3);
  for (int trial = 0; trial < 300; ++trial) {
    const int range = trial % 3 == 0 ? 5 : 12, flat = trial % 5 == 0 ? 1 : 4;
    const std::size_t count = 2 + random.next() % 20;
    std::vector<Int3> used;
    std::vector<std::array<Int3, 3>> soup;
    for (int attempt = 0; soup.size() < count && attempt < 400; ++attempt) {
      std::array<Int3, 3> t;
      bool fresh = true;
      for (Int3& p : t) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          p[axis] = static_cast<long>(random.next() % static_cast<unsigned>(axis == 2 && flat == 1 ? 2 : range));
        }
        fresh = fresh && std::find(used.begin(), used.end(), p) == used.end();
      }
      if (!fresh || cross(minus(t[1], t[0]), minus(t[2], t[0])) == Int3{0, 0, 0}) continue;
      used.insert(used.end(), t.begin(), t.end());
      soup.push_back(t);
    }
    TriangleMesh mesh;
    std::size_t expected = 0;
    for (std::size_t i = 0; i < soup.size(); ++i) {
      const int n = static_cast<int>(mesh.vertices.size());
      for (const Int3& p : soup[i]) mesh.vertices.emplace_back(p[0], p[1], p[2]);
      mesh.triangles.push_back({n, n + 1, n + 2});
      for (std::size_t j = 0; j < i; ++j) expected += meet(soup[i], soup[j]) ? 1 : 0;
    }
    EXPECT_EQ(self_intersection_count(mesh), expected) << "trial " << trial;
    // Far away and in fractions of a mm: the same, as long as the coordinates stay exact.
    const TriangleMesh far = test::moved(mesh, [](const Vec3& x) -> Vec3 { return 0.125 * x + Vec3(1000, -500, 250); });
    EXPECT_EQ(self_intersection_count(far), expected) << "trial " << trial;
  }
}

TEST(SelfIntersection, NeighboursAreNotReported) {
  EXPECT_EQ(self_intersection_count(test::sphere(4, 10)), 0U);
  EXPECT_EQ(self_intersection_count(test::torus(40, 20, 10, 3)), 0U);
  EXPECT_EQ(self_intersection_count(test::box({0, 0, 0}, {1, 1, 1})), 0U);
  EXPECT_EQ(self_intersection_count(test::together(test::sphere(3, 10), test::sphere(3, 5))), 0U);
  EXPECT_GT(self_intersection_count(test::together(test::sphere(3, 10), test::sphere(3, 10, {5, 0, 0}))), 10U);
  // A seam of doubled vertices is not a contact.
  const TriangleMesh whole = test::sphere(2, 10);
  TriangleMesh loose;
  for (const auto& t : whole.triangles) {
    const int n = static_cast<int>(loose.vertices.size());
    for (const int i : t) loose.vertices.push_back(whole.vertices[static_cast<std::size_t>(i)]);
    loose.triangles.push_back({n, n + 1, n + 2});
  }
  EXPECT_EQ(self_intersection_count(loose), 0U);
}

TEST(SelfIntersection, FoldsAreFound) {
  TriangleMesh m = test::sphere(3, 10);
  m.vertices[0] = -1.5 * m.vertices[0];  // drawn through the other side
  EXPECT_GT(self_intersection_count(m), 0U);
  // Two facets at one vertex that cross: the oracle's case is a pair of its own.
  TriangleMesh fan;
  fan.vertices = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 1, -1}, {2, 1, 3}};
  fan.triangles = {{0, 1, 2}, {0, 3, 4}};
  EXPECT_EQ(self_intersection_count(fan), 1U);
}

TEST(BorderLoops, AStripAroundHasTwoAndTheSurfaceToTheLeft) {
  std::vector<std::array<int, 3>> triangles;  // 0 .. 7 below, 8 .. 15 above, counter-clockwise from outside
  for (int k = 0; k < 8; ++k) {
    const int next = (k + 1) % 8;
    triangles.push_back({k, next, 8 + next});
    triangles.push_back({k, 8 + next, 8 + k});
  }
  EXPECT_THAT(border_loops(triangles), testing::ElementsAre(testing::ElementsAre(0, 1, 2, 3, 4, 5, 6, 7),
                                                            testing::ElementsAre(8, 15, 14, 13, 12, 11, 10, 9)));
  EXPECT_TRUE(border_loops({{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}).empty());
}

}  // namespace
}  // namespace pellicle
