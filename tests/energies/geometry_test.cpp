// Areas, area vectors and their adjoint, volume, curvature, averaging over the mesh.

#include <gmock/gmock.h>

#include <limits>
#include <numbers>
#include <set>

#include "pellicle/mesh/measure.h"
#include "test_surfaces.h"

namespace pellicle {
namespace {

using test::random_vector;
using test::Samples;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(SampleGraph, neighbours_are_mutual_ascending_and_make_euler_two) {
  const Samples s = test::sphere_samples(3, 1.0, Vec3::Zero(), StartSolid::tetrahedron);
  const SampleGraph graph(s.layout);
  std::set<std::pair<int, int>> directed;
  for (int i = 0; i < s.layout.sample_count(); ++i) {
    for (int k = graph.start[static_cast<std::size_t>(i)]; k < graph.start[static_cast<std::size_t>(i) + 1]; ++k) {
      const int j = graph.neighbour[static_cast<std::size_t>(k)];
      EXPECT_TRUE(directed.insert({i, j}).second) << "named twice";
      if (k > graph.start[static_cast<std::size_t>(i)]) {
        EXPECT_LT(graph.neighbour[static_cast<std::size_t>(k) - 1], j);
      }
    }
  }
  for (const auto& [i, j] : directed) EXPECT_TRUE(directed.contains({j, i}));
  EXPECT_EQ(
      s.layout.sample_count() - static_cast<int>(directed.size()) / 2 + static_cast<int>(s.layout.triangles.size()), 2);
}

TEST(Areas, sum_to_the_facets_and_vectors_of_a_closed_surface_to_nothing) {
  RandomEngine random(1);
  const Samples s = test::crumpled_sphere(3, 10.0, 1.0, random);
  const TriangleMesh mesh{s.x, s.layout.triangles, {}};
  EXPECT_NEAR(sum(sample_areas(s.layout, s.x)) / area_of(mesh), 1.0, 1e-12);
  Vec3 total = Vec3::Zero();
  for (const Vec3& a : area_vectors(s.layout, s.x)) total += a;
  EXPECT_LE(total.norm(), 1e-10);
  EXPECT_NEAR(facet_volume(s.layout, s.x) / volume_of(mesh), 1.0, 1e-12);
}

TEST(Areas, point_outward_on_a_sphere) {
  const Samples s = test::sphere_samples(3, 5.0, Vec3(1, 2, 3));
  const std::vector<Vec3> a = area_vectors(s.layout, s.x);
  const std::vector<double> area = sample_areas(s.layout, s.x);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_GE(a[i].dot(s.normal[i]), 0.99 * area[i]);
}

TEST(Areas, flux_of_a_linear_field_is_its_divergence_times_the_volume) {
  RandomEngine random(2);
  for (int trial = 0; trial < 5; ++trial) {
    const Samples s = test::crumpled_sphere(2, 10.0, 2.0, random);
    const Mat3 m = test::random_matrix(random);
    const Vec3 c = random_vector(random, 5.0);
    const std::vector<Vec3> a = area_vectors(s.layout, s.x);
    double flux = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) flux += (m * s.x[i] + c).dot(a[i]);
    EXPECT_NEAR(flux, m.trace() * facet_volume(s.layout, s.x), 1e-9 * 4000);
  }
}

TEST(Areas, adjoint_is_the_derivative_of_the_area_vectors) {
  RandomEngine random(3);
  const Samples s = test::crumpled_sphere(2, 10.0, 2.0, random);
  std::vector<Vec3> bar(s.x.size()), direction(s.x.size()), gradient(s.x.size(), Vec3::Zero());
  for (std::size_t i = 0; i < s.x.size(); ++i) {
    bar[i] = random_vector(random);
    direction[i] = random_vector(random);
  }
  pull_back_area_vectors(s.layout, s.x, bar, gradient);
  double expected = 0.0, slope = 0.0;
  std::vector<Vec3> up = s.x, down = s.x;
  const double step = 0.25;  // area vectors are quadratic: central differences are exact
  for (std::size_t i = 0; i < s.x.size(); ++i) {
    expected += gradient[i].dot(direction[i]);
    up[i] += step * direction[i];
    down[i] -= step * direction[i];
  }
  const std::vector<Vec3> a = area_vectors(s.layout, up), b = area_vectors(s.layout, down);
  for (std::size_t i = 0; i < a.size(); ++i) slope += bar[i].dot(a[i] - b[i]) / (2.0 * step);
  ASSERT_GT(std::abs(slope), 1.0);
  EXPECT_NEAR(slope / expected, 1.0, 1e-10);
}

TEST(Volume, its_gradient_is_the_area_vectors) {
  RandomEngine random(4);
  const Samples s = test::crumpled_sphere(2, 10.0, 2.0, random);
  const std::vector<Vec3> a = area_vectors(s.layout, s.x);
  for (std::size_t i = 0; i < s.x.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      std::vector<Vec3> up = s.x, down = s.x;  // the volume is linear in each coordinate
      up[i][c] += 1.0;
      down[i][c] -= 1.0;
      EXPECT_NEAR(0.5 * (facet_volume(s.layout, up) - facet_volume(s.layout, down)), a[i][c], 1e-9);
    }
  }
}

TEST(Volume, far_from_the_origin_nothing_is_lost) {
  const Samples here = test::sphere_samples(3, 1.0);
  const Samples far = test::sphere_samples(3, 1.0, Vec3(1e6, -1e6, 1e6));
  EXPECT_NEAR(facet_volume(far.layout, far.x) / facet_volume(here.layout, here.x), 1.0, 1e-8);
}

TEST(Curvature, of_spheres_and_its_scaling) {
  for (const double radius : {5.0, 20.0}) {
    const Samples s = test::sphere_samples(4, radius, Vec3(9, 9, 9));
    const std::vector<double> k = sum_of_curvatures(s.surface());
    // Where five facets meet, a third of their area is not what belongs to the sample: a sixth off there, nowhere else.
    const SampleGraph graph(s.layout);
    for (int i = 0; i < s.layout.sample_count(); ++i) {
      EXPECT_NEAR(k[static_cast<std::size_t>(i)] * radius, 2.0, graph.degree(i) == 6 ? 0.1 : 0.35);
    }
    EXPECT_NEAR(sum(k) / static_cast<double>(k.size()) * radius, 2.0, 0.02);
  }
}

TEST(Curvature, of_an_ellipsoid_at_its_poles) {
  Samples s = test::sphere_samples(5, 1.0);
  const Vec3 axes(12.0, 10.0, 8.0);
  for (std::size_t i = 0; i < s.x.size(); ++i) {
    s.normal[i] = s.x[i].cwiseQuotient(axes).normalized();
    s.x[i] = s.x[i].cwiseProduct(axes);
  }
  const std::vector<double> k = sum_of_curvatures(s.surface());
  for (std::size_t i = 0; i < s.x.size(); ++i) {
    if (s.layout.reference[i].z() < 0.999) continue;
    EXPECT_NEAR(k[i], 8.0 / 144.0 + 8.0 / 100.0, 0.01);
  }
}

TEST(Average, keeps_constants_fills_gaps_and_smooths) {
  const Samples s = test::sphere_samples(3, 1.0);
  const SampleGraph graph(s.layout);
  std::vector<double> constant(s.x.size(), 4.25);
  constant[3] = constant[10] = kNaN;
  average_over_mesh(graph, 2, constant);
  for (const double v : constant) EXPECT_NEAR(v, 4.25, 1e-12);
  std::vector<double> spike(s.x.size(), 0.0);
  spike[5] = 1.0;
  average_over_mesh(graph, 1, spike);
  EXPECT_NEAR(spike[5], 1.0 / (1.0 + graph.degree(5)), 1e-12);
  std::vector<double> nothing(s.x.size(), kNaN);
  average_over_mesh(graph, 3, nothing);
  for (const double v : nothing) EXPECT_TRUE(std::isnan(v));
}

}  // namespace
}  // namespace pellicle
