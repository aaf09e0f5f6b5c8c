#include "pellicle/mesh/distance.h"

#include <gmock/gmock.h>

#include <limits>

#include "pellicle/base/errors.h"
#include "pellicle/base/random.h"
#include "test_meshes.h"

namespace pellicle {
namespace {

// Independent of the code under test: the case distinction by Voronoi regions, in long double.
using Long3 = Eigen::Matrix<long double, 3, 1>;
long double distance_to_triangle(const Vec3& point, const Vec3& v0, const Vec3& v1, const Vec3& v2) {
  const Long3 p = point.cast<long double>(), a = v0.cast<long double>(), b = v1.cast<long double>(),
              c = v2.cast<long double>();
  const Long3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const long double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp),
                    d6 = ac.dot(cp);
  if (d1 <= 0 && d2 <= 0) return ap.norm();
  if (d3 >= 0 && d4 <= d3) return bp.norm();
  if (d6 >= 0 && d5 <= d6) return cp.norm();
  const long double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return (ap - d1 / (d1 - d3) * ab).norm();
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return (ap - d2 / (d2 - d6) * ac).norm();
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return (bp - (d4 - d3) / (d4 - d3 + d5 - d6) * (c - b)).norm();
  return std::abs(ap.dot(ab.cross(ac).normalized()));
}

double brute_force(const TriangleMesh& m, const Vec3& x) {
  long double best = std::numeric_limits<long double>::infinity();
  for (const auto& t : m.triangles) {
    best = std::min(best, distance_to_triangle(x, m.vertices[std::size_t(t[0])], m.vertices[std::size_t(t[1])],
                                               m.vertices[std::size_t(t[2])]));
  }
  return static_cast<double>(best);
}

TEST(ClosestPoint, ExactFarFromTheOrigin) {
  RandomEngine random(11);
  const Vec3 centre(1000, -800, 1200);
  const TriangleMesh m = test::blob(3, 30, centre);
  const ClosestPoint closest(m);
  for (int i = 0; i < 400; ++i) {
    const double reach = i % 4 == 0 ? 2000 : 50;  // some queries from far outside
    const Vec3 x = centre + reach * Vec3(random.normal(), random.normal(), random.normal());
    const auto hit = closest.query(x);
    const double expected = brute_force(m, x);
    EXPECT_LE(std::abs(hit.distance - expected), 1e-9 * std::max(1.0, expected));
    EXPECT_LE(std::abs((hit.point - x).norm() - hit.distance), 1e-9 * std::max(1.0, expected));
    const auto& t = m.triangles.at(static_cast<std::size_t>(hit.triangle));
    EXPECT_LE(distance_to_triangle(hit.point, m.vertices[std::size_t(t[0])], m.vertices[std::size_t(t[1])],
                                   m.vertices[std::size_t(t[2])]),
              1e-9);
    EXPECT_EQ(closest.query(x, expected * 1.001 + 1e-6).triangle, hit.triangle);
    EXPECT_EQ(closest.query(x, expected * 0.999 - 1e-6).triangle, -1);
  }
}

TEST(ClosestPoint, OnTheSurfaceTheDistanceVanishes) {
  const TriangleMesh m = test::blob(3, 30, {1000, 1000, 1000});
  const ClosestPoint closest(m);
  for (const Vec3& v : m.vertices) EXPECT_LE(closest.query(v).distance, 1e-12);
  for (const Vec3& x : sample_surface(m, 500)) EXPECT_LE(closest.query(x).distance, 1e-9);
}

TEST(ClosestPoint, TinyHugeFlatAndEmptyMeshes) {
  for (const double scale : {1e-6, 1.0, 1e6}) {
    const ClosestPoint closest(test::box(Vec3::Zero(), Vec3(1, 2, 3) * scale));
    EXPECT_NEAR(closest.query(Vec3(0.5, 1, 4) * scale).distance / scale, 1.0, 1e-12);
    EXPECT_NEAR(closest.query(Vec3(0.4, 1, 1.5) * scale).distance / scale, 0.4, 1e-12);
  }
  TriangleMesh line;
  line.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  line.triangles = {{0, 1, 2}};
  EXPECT_DOUBLE_EQ(ClosestPoint(line).query({1.5, 3, 4}).distance, 5.0);
  EXPECT_EQ(ClosestPoint(TriangleMesh{}).query({0, 0, 0}).triangle, -1);
  line.triangles = {{0, 1, 7}};
  EXPECT_THROW(ClosestPoint{line}, BadData);
}

TEST(SurfaceDistances, ConcentricSpheres) {
  const TriangleMesh a = test::sphere(5, 10), b = test::sphere(5, 11);
  const SurfaceDistances d = surface_distances(a, b, 1.1);
  EXPECT_NEAR(d.assd, 1.0, 0.005);
  EXPECT_NEAR(d.hd95, 1.0, 0.01);
  EXPECT_NEAR(d.hd, 1.0, 0.01);
  EXPECT_EQ(d.nsd, 1.0);
  EXPECT_EQ(surface_distances(a, b, 0.9).nsd, 0.0);
  const SurfaceDistances e = surface_distances(b, a, 1.1);
  EXPECT_EQ(d.assd, e.assd);
  EXPECT_EQ(d.hd95, e.hd95);
  EXPECT_EQ(d.hd, e.hd);
  const SurfaceDistances same = surface_distances(a, a, 0.0);
  EXPECT_LE(same.hd, 1e-9);
  EXPECT_THROW(surface_distances(a, TriangleMesh{}, 1.0), BadData);
}

// A box and the same box made longer by 1 at one end: one face of six moves by 1, its walls grow.
TEST(SurfaceDistances, WeighsByAreaWhateverTheTriangles) {
  const TriangleMesh a = test::box({0, 0, 0}, {10, 10, 10});
  TriangleMesh fine = a;  // the face x = 10 in 2 * 4^4 facets, all others in two
  for (int level = 0; level < 4; ++level) {
    const auto before = fine.triangles;
    fine.triangles.clear();
    for (const auto& t : before) {
      const auto vertex = [&](std::size_t i) { return fine.vertices[std::size_t(t[i])]; };
      if (vertex(0).x() + vertex(1).x() + vertex(2).x() < 29.9) {
        fine.triangles.push_back(t);
        continue;
      }
      const int n = static_cast<int>(fine.vertices.size());
      const Vec3 ab = 0.5 * (vertex(0) + vertex(1)), bc = 0.5 * (vertex(1) + vertex(2)),
                 ca = 0.5 * (vertex(2) + vertex(0));
      fine.vertices.insert(fine.vertices.end(), {ab, bc, ca});
      fine.triangles.insert(fine.triangles.end(),
                            {{t[0], n, n + 2}, {n, t[1], n + 1}, {n + 2, n + 1, t[2]}, {n, n + 1, n + 2}});
    }
  }
  const TriangleMesh b = test::box({0, 0, 0}, {11, 10, 10});
  // From a, a point of the end face at r from its rim is min(1, r) away (the walls of b pass at the rim): 64 mm^2 at 1
  // and, by the area 4 (10 - 2r) dr at r, 4 (5 - 2/3). From b, the end face likewise, and the new wall, 40 mm^2, 1/2.
  const double face = 64.0 + 4.0 * (5.0 - 2.0 / 3.0);
  // Seen from b its own end face is 1 away everywhere.
  const double expected = (face + 100.0 + 40.0 * 0.5) / (600.0 + 640.0);
  const SurfaceDistances coarse = surface_distances(a, b, 0.5), dense = surface_distances(fine, b, 0.5);
  EXPECT_NEAR(coarse.assd, dense.assd, 2e-3);
  EXPECT_NEAR(coarse.nsd, dense.nsd, 2e-3);
  EXPECT_NEAR(coarse.assd, expected, 2e-3);
  EXPECT_NEAR(coarse.hd, 1.0, 1e-12);
}

TEST(SampleSurface, SharesFollowArea) {
  const TriangleMesh m = test::together(test::sphere(3, 10), test::sphere(2, 20, {100, 0, 0}));
  int second = 0;
  const auto points = sample_surface(m, 10000);
  ASSERT_EQ(points.size(), 10000U);
  for (const Vec3& x : points) second += x.x() > 50 ? 1 : 0;
  EXPECT_NEAR(second / 10000.0, 0.8, 0.01);
}

// The quick question has the answer of the exact one, also at the very distance.
TEST(ClosestPoint, IsWithinAgreesWithQuery) {
  const TriangleMesh mesh = test::sphere(3, 10.0);
  const ClosestPoint nearest(mesh);
  RandomEngine random(5);
  for (int k = 0; k < 500; ++k) {
    const Vec3 x(random.uniform(-14.0, 14.0), random.uniform(-14.0, 14.0), random.uniform(-14.0, 14.0));
    const double distance = nearest.query(x).distance, limit = random.uniform(0.0, 6.0);
    EXPECT_EQ(nearest.is_within(x, limit), nearest.query(x, limit).triangle >= 0);
    EXPECT_TRUE(nearest.is_within(x, distance * (1.0 + 1e-9)));
    EXPECT_FALSE(nearest.is_within(x, distance * (1.0 - 1e-9)));
  }
}

}  // namespace
}  // namespace pellicle
