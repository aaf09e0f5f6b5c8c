// Springs: where points are attached, rows against the exact distance, invariance, robustness.
#include "pellicle/energies/springs.h"

#include <gmock/gmock.h>

#include <numbers>

#include "pellicle/energies/rim_springs.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/mesh/points/point_tree.h"
#include "test_surfaces.h"

namespace pellicle {
namespace {

using test::random_vector;
using test::Samples;

double energy_of(const ScalarRows& rows, const std::vector<Vec3>& x) {
  double e = 0.0;
  for (std::size_t r = 0; r < rows.size(); ++r) e += 0.5 * std::pow(rows.residual(r, x), 2);
  return e;
}

// Largest fault of the offsets of points up to `far` off a sphere of radius 10, seen through facets of this level.
double worst_offset(int level, double far) {
  const Vec3 centre(3, -2, 1);
  const Samples s = test::sphere_samples(level, 10.0, centre);
  RandomEngine random(1);
  std::vector<Vec3> points(300);
  for (Vec3& p : points) p = centre + (10.0 + random.uniform(-far, far)) * random_vector(random).normalized();
  double worst = 0.0;
  const auto at = attach(points, s.surface());
  for (std::size_t k = 0; k < points.size(); ++k) {
    worst = std::max(worst, std::abs(at[k].offset - ((points[k] - centre).norm() - 10.0)));
    EXPECT_NEAR(at[k].barycentric.sum(), 1.0, 1e-12);
    EXPECT_GE(at[k].barycentric.minCoeff(), 0.0);
  }
  return worst;
}

TEST(Attach, SeesTheSmoothSphereThroughItsFacets) {
  // The facets of level 2 miss the sphere by up to 1.8 % of its radius. The places are lifted off them by their
  // normals, and of points near the surface the fault falls by more than the second power of the facets' size.
  const double coarse = worst_offset(2, 0.01), middle = worst_offset(3, 0.01), fine = worst_offset(4, 0.01);
  EXPECT_TRUE(middle < coarse / 6.0) << middle << " after " << coarse;
  EXPECT_TRUE(fine < middle / 6.0) << fine << " after " << middle;
  EXPECT_TRUE(fine < 2e-3) << fine;
}

TEST(Attach, FarPointsToSecondOrder) {
  // The nearest place of the facets is not below the point but aside by the turn of the facet times the distance.
  const double coarse = worst_offset(2, 2.0), middle = worst_offset(3, 2.0), fine = worst_offset(4, 2.0);
  EXPECT_TRUE(middle < coarse / 3.0) << middle << " after " << coarse;
  EXPECT_TRUE(fine < middle / 3.0) << fine << " after " << middle;
}

TEST(SpringRows, AreTheDistancesToTheTangentPlanes) {
  RandomEngine random(2);
  const Samples s = test::sphere_samples(3, 5.0);
  std::vector<Vec3> points;
  std::vector<double> weights;
  for (int i = 0; i < 40; ++i) {
    points.emplace_back(6.0 * random_vector(random));
    weights.push_back(i % 5 == 0 ? 0.0 : random.uniform(0.1, 2.0));
  }
  const SampledSurface samples = s.surface();
  const auto at = attach(points, samples);
  const double total = 17.0, weight = 0.3;
  double expected = 0.0, sliding = 0.0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    expected += weight * weights[k] / total * at[k].offset * at[k].offset;
    sliding += weight * weights[k] / total * 0.25 * (at[k].distance * at[k].distance - at[k].offset * at[k].offset);
  }
  EXPECT_NEAR(energy_of(spring_rows(s.layout, points, at, weights, total, 0.0, weight), s.x), expected,
              1e-9 * expected);
  EXPECT_NEAR(energy_of(spring_rows(s.layout, points, at, weights, total, 0.25, weight), s.x), expected + sliding,
              1e-9 * expected);
}

// The rows' derivative is that of the exact squared distance to the facets, up to how normals turn (second order).
TEST(SpringRows, GradientAgainstFiniteDifferencesOfTheTrueDistance) {
  RandomEngine random(3);
  Samples s = test::sphere_samples(2, 5.0);
  std::vector<Vec3> points(30);
  for (Vec3& p : points) p = (5.0 + 0.02 * random.normal()) * random_vector(random).normalized();
  const auto exact = [&](const std::vector<Vec3>& x) {
    const SampledSurface samples(s.layout, {x, s.normal, {}});
    double e = 0.0;
    for (const auto& a : attach(points, samples)) e += a.offset * a.offset;
    return e;
  };
  const SampledSurface samples = s.surface();
  const ScalarRows rows = spring_rows(s.layout, points, attach(points, samples), {}, 1.0, 0.0, 1.0);
  std::vector<Vec3> direction = s.normal;
  for (Vec3& d : direction) d *= random.uniform(-1.0, 1.0);
  double by_rows = 0.0;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    double along = 0.0;
    for (auto k = static_cast<std::size_t>(rows.start[r]); k < static_cast<std::size_t>(rows.start[r + 1]); ++k) {
      along += rows.coefficient[k].dot(direction[static_cast<std::size_t>(rows.sample[k])]);
    }
    by_rows += rows.residual(r, s.x) * along;
  }
  const double h = 1e-5;
  std::vector<Vec3> plus = s.x, minus = s.x;
  for (std::size_t i = 0; i < s.x.size(); ++i) {
    plus[i] += h * direction[i];
    minus[i] -= h * direction[i];
  }
  const double numeric = (exact(plus) - exact(minus)) / (2.0 * h);
  EXPECT_TRUE(std::abs(by_rows - numeric) <= 0.02 * std::abs(numeric)) << by_rows << " against " << numeric;
}

TEST(SpringRows, DoNotKnowThePlace) {
  RandomEngine random(4);
  const Samples s = test::crumpled_sphere(2, 5.0, 0.2, random);
  std::vector<Vec3> points(30);
  for (Vec3& p : points) p = 6.0 * random_vector(random);
  const test::Motion motion = test::random_motion(random);
  Samples moved = s;
  std::vector<Vec3> moved_points = points;
  for (Vec3& p : moved.x) p = motion(p);
  for (Vec3& n : moved.normal) n = motion.turn * n;
  for (Vec3& p : moved_points) p = motion(p);
  const auto energy = [](const Samples& at, const std::vector<Vec3>& y) {
    return energy_of(spring_rows(at.layout, y, attach(y, at.surface()), {}, 30.0, 0.1, 1.0), at.x);
  };
  EXPECT_NEAR(energy(moved, moved_points) / energy(s, points), 1.0, 1e-9);
}

TEST(ReverseSprings, MeasureASphereWithinASphere) {
  const Samples inner = test::sphere_samples(3, 9.0), outer = test::sphere_samples(5, 10.0);
  const TriangleMesh data{outer.x, outer.layout.triangles, {}};
  const ClosestPoint nearest(data);
  EXPECT_NEAR(energy_of(reverse_spring_rows(inner.surface(), nearest, {}, 5.0, 1.0), inner.x), 1.0, 0.01);
  EXPECT_EQ(reverse_spring_rows(inner.surface(), nearest, {}, 0.5, 1.0).size(), 0U);  // out of reach
  const std::vector<Vec3> inward(data.triangles.size(), Vec3(0, 0, -1));
  EXPECT_LT(reverse_spring_rows(inner.surface(), nearest, inward, 5.0, 1.0).size(), inner.x.size());
}

// A ball of samples in points of a smaller one: all are beyond. Points that leave out a cap: the samples over the hole
// look along the surface to its rim and are left in peace.
TEST(OvershootRows, PullBackWhatIsBeyondThePointsAndSpareHoles) {
  const Samples outer = test::sphere_samples(3, 6.0), inner = test::sphere_samples(3, 5.0);
  const PointTree tree(inner.x);
  const ScalarRows rows = overshoot_rows(outer.surface(), tree, 0.5, 1.0);
  EXPECT_EQ(rows.size(), outer.x.size());
  EXPECT_NEAR(energy_of(rows, outer.x), 1.0, 0.01);
  EXPECT_LT(energy_of(rows, inner.x), 1e-3);
  EXPECT_EQ(overshoot_rows(outer.surface(), tree, 1.5, 1.0).size(), 0U);

  std::vector<Vec3> open = outer.x;
  std::erase_if(open, [](const Vec3& x) { return x.z() > 5.0; });
  EXPECT_EQ(overshoot_rows(outer.surface(), PointTree(open), 0.5, 1.0).size(), 0U);
}

TEST(TukeyWeights, AreOneAtHomeAndNothingFarOff) {
  std::vector<double> distances(100, 0.1);
  distances.push_back(50.0);
  const auto w = tukey_weights(distances, 6.0, 1e-3);
  EXPECT_TRUE(w[0] > 0.95);
  EXPECT_EQ(w.back(), 0.0);
}

TEST(HuberWeights, AreOneAtHomeAndPullNoHarderFarOff) {
  std::vector<double> distances(100, 0.1);
  distances.push_back(50.0);
  distances.push_back(500.0);
  const auto w = huber_weights(distances, 3.0, 1e-3);
  EXPECT_EQ(w[0], 1.0);
  EXPECT_NEAR(w[100] * 50.0, w[101] * 500.0, 1e-12);
  EXPECT_NEAR(w[101] * 500.0, 3.0 * 1.4826 * 0.1, 1e-12);
  EXPECT_THAT(huber_weights({0.0, 0.0}, 3.0, 1e-3), testing::Each(1.0));
}

TEST(TargetRows, AreTheMeanSquaredDistance) {
  RandomEngine random(7);
  const Samples s = test::sphere_samples(2, 5.0);
  std::vector<Vec3> targets = s.x;
  for (Vec3& t : targets) t += Vec3(0.3, -0.4, 0.0);
  EXPECT_NEAR(energy_of(target_rows(targets, sample_areas(s.layout, s.x), 2.0), s.x), 2.0 * 0.25, 1e-9);
}

TEST(RimSprings, MeasureTheWayToTheCurveAndLetSamplesSlide) {
  constexpr int kAround = 48;
  RimCurve circle;  // of radius 5
  for (int k = 0; k < 720; ++k) {
    const double a = k * std::numbers::pi / 360;
    circle.x.emplace_back(5 * std::cos(a), 5 * std::sin(a), 0);
    circle.tangent.emplace_back(-std::sin(a), std::cos(a), 0);
    circle.outward.emplace_back(std::cos(a), std::sin(a), 0);
  }
  const RimLocator rim({circle});
  SampleLayout disc;
  for (int k = 1; k <= kAround; ++k) disc.triangles.push_back({0, k, k % kAround + 1});
  const auto placed = [&](double radius, double height, double turned) {
    SurfaceSamples samples;
    samples.x.emplace_back(0, 0, 0);
    for (int k = 0; k < kAround; ++k) {
      const double a = turned + 2 * k * std::numbers::pi / kAround;
      samples.x.emplace_back(radius * std::cos(a), radius * std::sin(a), height);
    }
    samples.normal.assign(samples.x.size(), Vec3::UnitZ());
    return SampledSurface(disc, samples);
  };
  const SampledSurface off = placed(6.0, 0.5, 0.001);
  const auto border = border_loops(disc.triangles);
  const ScalarRows rows = rim_spring_rows(border, off, rim, 3.0, 2.0);
  EXPECT_EQ(rows.size(), 2U * kAround);
  EXPECT_NEAR(energy_of(rows, off.x()), 2.0 * (1.0 + 0.25), 0.01);
  EXPECT_NEAR(energy_of(rows, placed(5.0, 0.0, 0.001).x()), 0.0, 1e-4);
  EXPECT_NEAR(energy_of(rows, placed(5.0, 0.0, 0.03).x()), 0.0, 1e-4);  // slid along
  EXPECT_EQ(rim_spring_rows(border, off, rim, 1.0, 2.0).size(), 0U);    // out of reach
  const Samples ball = test::sphere_samples(2, 5.0);
  EXPECT_EQ(rim_spring_rows(border_loops(ball.layout.triangles), ball.surface(), rim, 99.0, 1.0).size(), 0U);
}

}  // namespace
}  // namespace pellicle
