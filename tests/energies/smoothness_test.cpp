// Bending, tension and spacing: null spaces, values on spherical harmonics, scaling, the fold barrier.

#include <gmock/gmock.h>

#include <algorithm>
#include <numbers>

#include "pellicle/energies/bending.h"
#include "pellicle/energies/spacing.h"
#include "pellicle/energies/tension.h"
#include "test_surfaces.h"

namespace pellicle {
namespace {

using test::energy_of;
using test::random_matrix;
using test::random_vector;
using test::Samples;

const std::vector<StartSolid> kSolids{StartSolid::tetrahedron, StartSolid::octahedron, StartSolid::icosahedron};

// Real solid harmonics, degree by degree, one without symmetry to the axes of the mesh.
double harmonic(int degree, const Vec3& p) {
  static const Vec3 axis = Vec3(0.3, -0.5, 0.8).normalized();
  const double z = axis.dot(p);
  switch (degree) {
    case 2:
      return 1.5 * z * z - 0.5;
    case 3:
      return 0.5 * z * (5 * z * z - 3);
    default:
      return (35 * z * z * z * z - 30 * z * z + 3) / 8;
  }
}

TEST(Bending, affine_images_of_the_sphere_cost_nothing) {
  RandomEngine random(1);
  for (const StartSolid solid : kSolids) {
    for (const int level : {1, 2, 3, 4}) {
      const Samples s = test::sphere_samples(level, 1.0, Vec3::Zero(), solid);
      const VectorRows rows = bending_rows(s.layout);
      EXPECT_EQ(rows.size(), 2 * s.x.size());
      for (int trial = 0; trial < 5; ++trial) {
        const Mat3 a = 30.0 * random_matrix(random);
        const Vec3 shift = random_vector(random, 200.0);
        std::vector<Vec3> x;
        for (const Vec3& p : s.layout.reference) x.push_back(shift + a * p);
        EXPECT_LE(energy_of(rows, x), 1e-16 * std::pow(4.0, 2 * level) * 1e4);
      }
    }
  }
}

TEST(Bending, harmonics_count_as_the_formula_says_and_the_error_falls_with_the_mesh) {
  for (const StartSolid solid : kSolids) {
    for (const int degree : {2, 3, 4}) {
      const double ll = degree * (degree + 1);
      // The mean square of a Legendre polynomial over the sphere is 1/(2l+1).
      const double exact = 0.5 * ll * (ll - 2.0) / (2 * degree + 1);
      std::vector<double> error;
      for (const int level : {3, 4, 5}) {
        const Samples s = test::sphere_samples(level, 1.0, Vec3::Zero(), solid);
        std::vector<Vec3> x;
        for (const Vec3& p : s.layout.reference) x.emplace_back(0.0, harmonic(degree, p), 0.0);
        error.push_back(std::abs(energy_of(bending_rows(s.layout), x) / exact - 1.0));
      }
      const auto what = testing::Message() << "degree " << degree << " solid " << static_cast<int>(solid) << " errors "
                                           << error[0] << " " << error[1] << " " << error[2];
      EXPECT_LE(error[1], 0.6 * error[0]) << what;
      EXPECT_LE(error[2], 0.6 * error[1]) << what;
      EXPECT_LE(error[2], 0.035) << what;  // of the polygon that the level has for a sphere
    }
  }
}

TEST(Bending, scales_with_the_square_of_the_size_and_ignores_rigid_motions) {
  RandomEngine random(2);
  const Samples s = test::crumpled_sphere(3, 10.0, 1.0, random);
  const double energy = energy_of(bending_rows(s.layout), s.x);
  ASSERT_GT(energy, 1e-3);
  const test::Motion motion = test::random_motion(random);
  std::vector<Vec3> larger, moved;
  for (const Vec3& p : s.x) {
    larger.push_back(3.0 * p);
    moved.push_back(motion(p));
  }
  EXPECT_NEAR(energy_of(bending_rows(s.layout), larger) / energy, 9.0, 1e-9);
  EXPECT_NEAR(energy_of(bending_rows(s.layout), moved) / energy, 1.0, 1e-9);
}

TEST(Tension, sphere_has_the_square_of_its_radius) {
  for (const StartSolid solid : kSolids) {
    std::vector<double> error;
    for (const int level : {3, 4, 5}) {
      const Samples s = test::sphere_samples(level, 7.0, Vec3(3, -2, 50), solid);
      error.push_back(std::abs(energy_of(tension_rows(s.layout), s.x) / 49.0 - 1.0));
    }
    EXPECT_LE(error[1], 0.35 * error[0]) << "solid " << static_cast<int>(solid);  // second order
    EXPECT_LE(error[2], 0.35 * error[1]) << "solid " << static_cast<int>(solid);
    EXPECT_LE(error[2], 0.004) << "solid " << static_cast<int>(solid);
  }
}

TEST(Tension, scales_with_size_ignores_motions_and_vanishes_for_a_point) {
  RandomEngine random(3);
  const Samples s = test::crumpled_sphere(3, 10.0, 1.0, random);
  const VectorRows rows = tension_rows(s.layout);
  const double energy = energy_of(rows, s.x);
  const test::Motion motion = test::random_motion(random);
  std::vector<Vec3> larger, moved;
  for (const Vec3& p : s.x) {
    larger.push_back(3.0 * p);
    moved.push_back(motion(p));
  }
  EXPECT_NEAR(energy_of(rows, larger) / energy, 9.0, 1e-9);
  EXPECT_NEAR(energy_of(rows, moved) / energy, 1.0, 1e-9);
  EXPECT_LE(energy_of(rows, std::vector<Vec3>(s.x.size(), Vec3(5, 6, 7))), 1e-20);
}

// The second sum of the energy as its header states it, normals and areas held.
double fold_barrier(const Samples& s, const std::vector<Vec3>& x, double total_area, double weight) {
  const double r2 = total_area / (4.0 * std::numbers::pi);
  const double scale = total_area / sum(sample_areas(s.layout, s.layout.reference));
  double energy = 0.0;
  for (const auto& [a, b, c] : s.layout.triangles) {
    const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b), k = static_cast<std::size_t>(c);
    const auto& on = s.layout.reference;
    const double reference = scale * 0.5 * (on[j] - on[i]).cross(on[k] - on[i]).norm();
    const Vec3 mean = (s.normal[i] + s.normal[j] + s.normal[k]).normalized();
    const double share = 0.5 * (x[j] - x[i]).cross(x[k] - x[i]).dot(mean) / reference;
    const double missing = std::max(0.0, 0.25 - share);
    energy += weight * r2 / static_cast<double>(s.layout.triangles.size()) * missing * missing;
  }
  return energy;
}

TEST(Spacing, healthy_surface_is_at_rest_and_normal_moves_are_free) {
  const Samples s = test::sphere_samples(3, 12.0, Vec3(1, 2, 3), StartSolid::tetrahedron);
  const ScalarRows rows = spacing_rows(s.surface(), 0.3);
  EXPECT_EQ(rows.size(), 2 * s.x.size());  // no facet calls for the barrier
  EXPECT_LE(energy_of(rows, s.x), 1e-20);
  std::vector<Vec3> grown = s.x;
  for (std::size_t i = 0; i < grown.size(); ++i) grown[i] += 0.7 * s.normal[i];
  EXPECT_LE(energy_of(rows, grown), 1e-20);
}

TEST(Spacing, sliding_costs_its_mean_square) {
  const Samples s = test::sphere_samples(3, 12.0);
  const std::vector<double> area = sample_areas(s.layout, s.x);
  const ScalarRows rows = spacing_rows(s.surface(), 0.3);
  const double total = sum(area);
  RandomEngine random(4);
  std::vector<Vec3> slid = s.x;
  double expected = 0.0;
  for (std::size_t i = 0; i < slid.size(); ++i) {
    const Vec3 move = random_vector(random, 0.2);
    slid[i] += move;
    expected += 0.3 * area[i] / total * (move - move.dot(s.normal[i]) * s.normal[i]).squaredNorm();
  }
  EXPECT_NEAR(energy_of(rows, slid) / expected, 1.0, 1e-10);
}

TEST(Spacing, folded_facets_cost_as_stated_and_the_rows_are_the_derivative) {
  RandomEngine random(5);
  Samples s = test::sphere_samples(2, 10.0, Vec3::Zero(), StartSolid::octahedron);
  s.x[7] = s.x[static_cast<std::size_t>(SampleGraph(s.layout).neighbour[0])] + Vec3(0.3, -0.2, 0.4);  // folded over
  const std::vector<double> area = sample_areas(s.layout, s.x);
  const double total = sum(area), weight = 0.4;
  const ScalarRows rows = spacing_rows(s.surface(), weight);
  const double energy = fold_barrier(s, s.x, total, weight);
  ASSERT_GT(energy, 1e-4);
  ASSERT_GT(rows.size(), 2 * s.x.size());
  EXPECT_NEAR(energy_of(rows, s.x) / energy, 1.0, 1e-10);
  std::vector<Vec3> gradient(s.x.size(), Vec3::Zero());
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (auto k = static_cast<std::size_t>(rows.start[r]); k < static_cast<std::size_t>(rows.start[r + 1]); ++k) {
      gradient[static_cast<std::size_t>(rows.sample[k])] += rows.residual(r, s.x) * rows.coefficient[k];
    }
  }
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<Vec3> up = s.x, down = s.x;
    double expected = 0.0;
    for (std::size_t i = 0; i < s.x.size(); ++i) {
      const Vec3 d = random_vector(random);
      up[i] += 1e-5 * d;
      down[i] -= 1e-5 * d;
      expected += gradient[i].dot(d);
    }
    const double slope = (fold_barrier(s, up, total, weight) - fold_barrier(s, down, total, weight)) / 2e-5;
    EXPECT_NEAR(slope, expected, 1e-5 * std::max(1.0, std::abs(expected)));
  }
}

}  // namespace
}  // namespace pellicle
