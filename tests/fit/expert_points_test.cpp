// Expert points in fits, and the trace.

#include "pellicle/fit/expert_points.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fit_cases.h"
#include "pellicle/base/errors.h"
#include "pellicle/base/random.h"
#include "pellicle/energies/energy_kinds.h"
#include "pellicle/energies/springs.h"
#include "pellicle/solve/hold_out.h"

namespace pellicle {
namespace {

using namespace test;

ExpertPoints points_on(const TriangleMesh& mesh, int count) {
  return {.points = sample_surface(mesh, count)};
}

/// A ball of 10 mm that cannot be told from its surroundings where x > 2: the right edge is not to be seen.
Phantom half_hidden() {
  Phantom phantom = make_phantom([] {
    PhantomSettings s = small_phantom();
    s.radius = {10.0};
    return s;
  }());
  const ImageGrid& grid = phantom.image.grid;
  for (int k = 0; k < grid.size[2]; ++k) {
    for (int j = 0; j < grid.size[1]; ++j) {
      for (int i = 0; i < grid.size[0]; ++i) {
        if (grid.world_from_index(Vec3(i, j, k)).x() > 2.0) {
          phantom.image.at(i, j, k) = static_cast<float>(phantom.settings.inside);
        }
      }
    }
  }
  return phantom;
}

TEST(ExpertPoints, ShowTheEdgeThatTheImageDoesNot) {
  const Phantom phantom = half_hidden();
  FitOptions settings;
  settings.polarity = Polarity::bright;
  settings.boundary = Boundary::step;
  settings.similarity = false;
  settings.detail = 2;
  const Seed ball = SeedSphere{Vec3(-2, 0, 0), 5.0};
  const ExpertPoints points = points_on(phantom.truth_surface, 60);
  const FitResult with = fit_surface({phantom.image, {ball}, points}, settings);
  EXPECT_GE(dice(with.surface, phantom.truth), 0.97);
  ASSERT_TRUE(with.summary.points.has_value());
  EXPECT_EQ(with.summary.points->count, 60U);
  EXPECT_LE(with.summary.points->rms_mm, 0.5);
  EXPECT_GE(with.summary.points->max_mm, with.summary.points->rms_mm);
  const FitResult without = fit_surface({phantom.image, {ball}}, settings);
  EXPECT_LE(dice(without.surface, phantom.truth), 0.9);
  EXPECT_FALSE(without.summary.points.has_value());
}

TEST(ExpertPoints, AloneTheyDrawEveryModelToThem) {
  PhantomSettings s = small_phantom("bean");
  s.radius = {10.0};
  const Phantom phantom = make_phantom(s);
  const ExpertPoints points = points_on(phantom.truth_surface, 150);
  for (const ModelKind kind : {ModelKind::normal, ModelKind::spline, ModelKind::catmull_clark, ModelKind::slime}) {
    ModelChoice choice;
    choice.kind = kind;
    const std::optional<Surface> start = ellipsoid_of(points, choice, 1.0);
    ASSERT_TRUE(start.has_value());
    const Surface drawn =
        drawn_to_points(phantom.image, *start, points, plan_for({}, StartKind::outlined, true).outline, {});
    EXPECT_LT(distances_to(points, drawn, 1.0).rms_mm, 0.3) << model_name(drawn.model);
    EXPECT_LT(distances_to(points, drawn, 1.0).rms_mm, 0.5 * distances_to(points, *start, 1.0).rms_mm);
    EXPECT_GE(dice(drawn, phantom.truth), 0.95) << model_name(drawn.model);
  }
}

TEST(ExpertPoints, OfAnEllipsoidGiveTheEllipsoid) {
  RandomEngine random(3);
  const Vec3 half_axes(12, 9, 7), centre(3, 1, -2);
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  ExpertPoints points;
  for (int k = 0; k < 4000; ++k) {
    const Vec3 u = Vec3(random.normal(), random.normal(), random.normal()).normalized();
    points.points.emplace_back(centre + turn * half_axes.cwiseProduct(u));
  }
  ModelChoice spline;  // exact for ellipsoids
  spline.kind = ModelKind::spline;
  const std::optional<Surface> surface = ellipsoid_of(points, spline, 1.0);
  ASSERT_TRUE(surface.has_value());
  EXPECT_NEAR(volume(*surface) / (4.0 / 3.0 * M_PI * half_axes.prod()), 1.0, 0.05);
  EXPECT_LE(distances_to(points, *surface, 1.0).max_mm, 0.6);
}

TEST(ExpertPoints, TooFewOrFlatOnesSayNothingOfTheWhole) {
  ExpertPoints points;
  for (int k = 0; k < 30; ++k) points.points.emplace_back(10.0 * std::cos(k), 10.0 * std::sin(k), 0.0);
  EXPECT_FALSE(ellipsoid_of(points, {}, 1.0).has_value());
  points.points.resize(11);
  for (Vec3& p : points.points) p.z() = p.x() * p.y();
  EXPECT_FALSE(ellipsoid_of(points, {}, 1.0).has_value());
}

// A stray point pulls with a bounded force: twice as far off is no stronger.
TEST(ExpertPoints, AStrayOnePullsNoHarderTheFurtherOffItIs) {
  const Surface ball{start_model({}), affine_image(start_model({}), Vec3::Zero(), 10.0 * Mat3::Identity())};
  const SampleLayout layout = layout_of(ball.model, 4);
  const SampledSurface surface(layout, ball);
  const auto pull_at = [&](double off, bool held) {
    ExpertPoints points;
    for (int k = 0; k < 40; ++k) {
      points.points.push_back(surface.x()[static_cast<std::size_t>(7 * k) % surface.x().size()]);
    }
    points.points.emplace_back((10.0 + off) * Vec3(1, 1, 1).normalized());
    points.held = held;
    const PointTargets targets = point_targets(points, surface, 1.0);
    const ScalarRows rows = spring_rows(layout, targets, 1.0);
    double force = 0.0;  // of the last point: |residual| times the size of its row
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const double size = rows.coefficient[static_cast<std::size_t>(rows.start[r])].norm();
      const double residual = std::abs(rows.residual(r, surface.x()));
      if (residual > 1e-3) force = std::max(force, size * residual);
    }
    EXPECT_NEAR(targets.at.back().distance, off, 0.3);
    return force;
  };
  EXPECT_NEAR(pull_at(20.0, false) / pull_at(10.0, false), 1.0, 0.05);
  EXPECT_NEAR(pull_at(1.6, false) / pull_at(0.8, false), 2.0, 0.3);
}

TEST(ExpertPoints, SettingsThatContradictAreRefused) {
  FitOptions options;
  options.energies[energy::springs] = 1.0;
  EXPECT_THROW(options.validate(false), SettingError);
  EXPECT_NO_THROW(options.validate(true));
  const auto refuses = [](const ExpertPoints& points) { EXPECT_THROW(pellicle::validate(points), SettingError); };
  refuses({.points = {Vec3::Zero(), Vec3::Ones()}, .weights = {1.0}});
  refuses({.points = {Vec3::Zero()}, .weights = {-1.0}});
  refuses({.points = {Vec3::Zero()}, .weights = {0.0}});
  refuses({.points = {Vec3(0, std::nan(""), 0)}});
}

TEST(Trace, DoesNotChangeTheResultAndLeadsToIt) {
  PhantomSettings s = small_phantom();
  s.radius = {8.0};
  const Phantom phantom = make_phantom(s);
  FitOptions settings;
  settings.detail = 2;
  const FitResult plain = fit_ball_seed(phantom.image, Vec3(1, 0, -1), 4.0, settings);
  settings.trace_every = 2;
  const FitResult traced = fit_ball_seed(phantom.image, Vec3(1, 0, -1), 4.0, settings);
  EXPECT_EQ(traced.surface.parameters, plain.surface.parameters);
  EXPECT_TRUE(plain.trace.empty());
  ASSERT_GE(traced.trace.size(), 4U);
  EXPECT_EQ(traced.trace.back().surface.parameters, traced.surface.parameters);
  EXPECT_EQ(traced.trace.front().step, 0);
  for (std::size_t f = 1; f < traced.trace.size(); ++f) {
    const TraceFrame &last = traced.trace[f - 1], &now = traced.trace[f];
    EXPECT_TRUE(now.step > last.step || now.step == 0) << f;
    EXPECT_LE(now.step, last.step + 2);
    EXPECT_GE(control_point_count(now.surface.model), control_point_count(last.surface.model));
  }
}

}  // namespace
}  // namespace pellicle
