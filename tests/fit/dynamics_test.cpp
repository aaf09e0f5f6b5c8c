// Surfaces that move, and the two ways to solve the steps of linear models.

#include "pellicle/solve/dynamics.h"

#include <gmock/gmock.h>

#include <cmath>
#include <optional>

#include "fit_cases.h"
#include "pellicle/base/errors.h"
#include "pellicle/energies/bending.h"
#include "pellicle/energies/energy_kinds.h"
#include "pellicle/energies/geometry.h"
#include "pellicle/energies/spacing.h"
#include "pellicle/solve/linear_system.h"

namespace pellicle {
namespace {

using namespace test;

/// A ball of 10 mm of any model that is asked to become a smooth lump about 1 mm away.
struct Lump {
  Surface surface;
  SampleLayout layout;
  std::vector<double> area;
  std::vector<GroupedOperator> operators;
  std::vector<NamedRows> rows;

  explicit Lump(ModelKind kind) : surface(start(kind)), layout(layout_of(surface.model, 2)) {
    const SampledSurface samples(layout, surface);
    area = samples.area();
    NormalTargets targets{std::vector<double>(area.size()), std::vector<double>(area.size(), 1.0)};
    for (std::size_t i = 0; i < area.size(); ++i) {
      const Vec3 u = layout.reference[i].normalized();
      targets.offset[i] = 0.6 + 0.5 * u.x() * u.y() - 0.4 * u.z() * u.z();
      targets.weight[i] = 1.0 + 0.5 * u.x();
    }
    operators.push_back(grouped_operator("bending", 1e-3, bending_rows(layout), layout));
    rows.push_back({"edge", offset_rows(samples, targets, 1.0)});
    rows.push_back({"spacing", spacing_rows(samples, 0.1)});
  }
  Lump(const Lump&) = delete;
  static Surface start(ModelKind kind) {
    ModelChoice choice;
    choice.kind = kind;
    const SurfaceModel model = start_model(choice);
    return refine(Surface{model, affine_image(model, Vec3(3, -2, 5), 10.0 * Mat3::Identity())});
  }
  SurfaceSamples at(const Parameters& parameters) const {
    SurfaceSamples samples;
    evaluate(surface.model, parameters, layout, false, samples);
    return samples;
  }
  std::optional<LinearSystem> closed_form() const {
    if (!layout.stencils) return std::nullopt;
    return std::optional<LinearSystem>(std::in_place, layout, surface.parameters.size() / 3, operators);
  }
  Parameters minimum(Solver solver, int calls) const {
    std::optional<LinearSystem> linear = closed_form();
    const StepProblem problem{&surface.model, &layout, &operators, rows, {}, linear ? &*linear : nullptr};
    Parameters parameters = surface.parameters;
    double trust_radius = 1e4;
    for (int i = 0; i < calls; ++i) EXPECT_TRUE(solve_step(problem, solver, 200, trust_radius, parameters).usable);
    return parameters;
  }
  /// Samples after each of so many time steps. \param velocity of the start, mm a unit of time.
  std::vector<std::vector<Vec3>> moved(const Motion& motion, const Vec3& velocity, int steps) {
    const std::vector<Vec3> start = at(surface.parameters).x;
    operators.push_back(motion_operator(motion, area, start, layout));
    std::optional<LinearSystem> linear = closed_form();
    const StepProblem problem{&surface.model, &layout, &operators, rows, {}, linear ? &*linear : nullptr};
    std::vector<std::vector<Vec3>> path{start, start};
    for (Vec3& x : path[0]) x -= motion.time_step * velocity;
    Parameters parameters = surface.parameters;
    for (int step = 0; step < steps; ++step) {
      aim_motion(motion, path[path.size() - 1], path[path.size() - 2], operators.back());
      double trust_radius = 1e4;
      EXPECT_TRUE(solve_step(problem, Solver::dynamic, 20, trust_radius, parameters).usable);
      path.push_back(at(parameters).x);
    }
    operators.pop_back();
    return path;
  }
};

double furthest(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double worst = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, (a[i] - b[i]).norm());
  return worst;
}

class LinearModel : public testing::TestWithParam<ModelKind> {};
INSTANTIATE_TEST_SUITE_P(All, LinearModel,
                         testing::Values(ModelKind::spline, ModelKind::catmull_clark, ModelKind::slime));

TEST_P(LinearModel, ClosedFormAndLevenbergMarquardtAgree) {
  const Lump lump(GetParam());
  const std::vector<Vec3> closed = lump.at(lump.minimum(Solver::least_squares, 1)).x;
  const std::vector<Vec3> iterated = lump.at(lump.minimum(Solver::levenberg_marquardt, 12)).x;
  EXPECT_GE(furthest(closed, lump.at(lump.surface.parameters).x), 0.3);
  EXPECT_LE(furthest(closed, iterated), 5e-4);
}

TEST_P(LinearModel, ClosedFormIsThereAtOnce) {
  const Lump lump(GetParam());
  const std::vector<Vec3> once = lump.at(lump.minimum(Solver::least_squares, 1)).x;
  const std::vector<Vec3> twice = lump.at(lump.minimum(Solver::least_squares, 2)).x;
  EXPECT_LE(furthest(once, twice), 1e-6);
}

class Moving : public testing::TestWithParam<ModelKind> {};
INSTANTIATE_TEST_SUITE_P(All, Moving,
                         testing::Values(ModelKind::normal, ModelKind::spline, ModelKind::catmull_clark,
                                         ModelKind::slime));

TEST_P(Moving, ComesToRestWhereTheEnergyIsLeast) {
  Lump lump(GetParam());
  const std::vector<Vec3> least = lump.at(lump.minimum(Solver::least_squares, 20)).x;
  for (const Motion& motion : {Motion{1.0, 0.0, 1.0}, Motion{1.0, 0.5, 0.5}}) {
    // The weakest pull (spacing, 0.2) gives the slowest motion: the rest that is left after 60 steps is far below 1e-3.
    const auto path = lump.moved(motion, Vec3(0.2, 0, 0), 60);
    EXPECT_GE(furthest(path[2], least), 0.05);
    EXPECT_LE(furthest(path.back(), least), 2e-3);
  }
}

TEST_P(Moving, FreeOfForcesKeepsItsVelocityAndDampingTakesAFixedShareAStep) {
  Lump lump(GetParam());
  lump.rows.clear();
  lump.operators.clear();
  const Vec3 velocity(0.7, -0.3, 0.4);
  for (const Motion& motion : {Motion{0.5, 2.0, 0.0}, Motion{0.5, 2.0, 1.0}}) {
    const auto path = lump.moved(motion, velocity, 6);
    const double kept = 1.0 / (1.0 + motion.time_step * motion.damping / motion.mass);
    for (std::size_t n = 2; n < path.size(); ++n) {
      const Vec3 step = motion.time_step * std::pow(kept, static_cast<double>(n - 1)) * velocity;
      for (std::size_t i = 0; i < path[n].size(); i += 17) {
        EXPECT_LE((path[n][i] - path[n - 1][i] - step).norm(), 1e-4 * velocity.norm());
      }
    }
  }
}

TEST(Motion, SwingsAsTheDampedOscillatorDoesToFirstOrderInTheTimeStep) {
  // Every sample pulled to a place 1 mm along x: E = |x - y|^2, stiffness 2. Translation alone, so
  // m x'' + d x' + 2 x = 0 with x(0) = -1, x'(0) = 0, whose solution is known.
  const double mass = 0.5, damping = 0.4, time = 2.0;
  std::vector<double> errors;
  for (const int steps : {25, 50, 100}) {
    Lump lump(ModelKind::catmull_clark);
    lump.operators.clear();
    lump.rows.clear();
    const std::vector<Vec3> start = lump.at(lump.surface.parameters).x;
    double total = sum(lump.area);
    ScalarRows pull;
    for (std::size_t i = 0; i < start.size(); ++i) {
      for (int c = 0; c < 3; ++c) {
        const double root = std::sqrt(2.0 * lump.area[i] / total);
        pull.add(static_cast<int>(i), root * Vec3::Unit(c));
        pull.close(root * (start[i][c] + (c == 0 ? 1.0 : 0.0)));
      }
    }
    lump.rows.push_back({"pull", pull});
    const auto path = lump.moved({time / steps, mass, damping}, Vec3::Zero(), steps);
    const double g = damping / (2.0 * mass), w = std::sqrt(2.0 / mass - g * g);
    const double exact = 1.0 - std::exp(-g * time) * (std::cos(w * time) + g / w * std::sin(w * time));
    errors.push_back(std::abs(path.back()[0].x() - start[0].x() - exact));
  }
  EXPECT_LE(errors[2], 0.05);
  EXPECT_NEAR(errors[0] / errors[1], 2.0, 0.4);
  EXPECT_NEAR(errors[1] / errors[2], 2.0, 0.25);
}

class DynamicFit : public testing::TestWithParam<ModelKind> {};
INSTANTIATE_TEST_SUITE_P(All, DynamicFit, testing::Values(ModelKind::normal, ModelKind::catmull_clark));

TEST_P(DynamicFit, EndsWhereTheStaticFitEnds) {
  PhantomSettings s = small_phantom("ellipsoid");
  s.size = {32, 32, 32};
  s.radius = {9, 7.5, 6};
  const Phantom phantom = make_phantom(s);
  FitOptions settings =
      one_stage({.name = "region",
                 .detail = 1,
                 .energies = {{energy::region, 1.0}, {energy::bending, 1e-3}, {energy::spacing, 0.05}},
                 .reach = 8.0,
                 .max_steps = 40,
                 .tolerance = 0.002});
  settings.model.kind = GetParam();
  settings.polarity = Polarity::bright;
  settings.boundary = Boundary::step;
  const FitResult still = fit_ball_seed(phantom.image, Vec3(1, -1, 1), 5.0, settings);
  settings.solver = Solver::dynamic;
  settings.time_step = 0.5;
  const FitResult moving = fit_ball_seed(phantom.image, Vec3(1, -1, 1), 5.0, settings);
  EXPECT_EQ(moving.summary.stages.front().termination, Termination::converged);
  EXPECT_GT(moving.summary.stages.front().steps, still.summary.stages.front().steps);
  EXPECT_LE(assd(moving.surface, tessellate(still.surface, 4)), 0.05);
}

TEST(DynamicFit, RefusesAMotionThatNothingHoldsBackAndOneThatIsNotAskedFor) {
  FitOptions settings;
  settings.mass = 1.0;
  EXPECT_THROW(settings.validate(), UsageError);
  settings.solver = Solver::dynamic;
  EXPECT_NO_THROW(settings.validate());
  settings.mass = settings.damping = 0.0;
  EXPECT_THROW(settings.validate(), UsageError);
  settings.damping = 1.0;
  settings.time_step = 0.0;
  EXPECT_THROW(settings.validate(), UsageError);
}

TEST(DynamicFit, RefinesUntilTheErrorTargetIsMetAndNoFurther) {
  PhantomSettings s = small_phantom("bean");
  s.size = {40, 32, 32};
  s.radius = {7.0};
  const Phantom phantom = make_phantom(s);
  FitOptions settings;
  settings.polarity = Polarity::bright;
  settings.boundary = Boundary::step;
  settings.similarity = false;
  settings.error_target_mm = 2.0;
  const FitResult coarse = fit_ball_seed(phantom.image, Vec3(0, 0, 0), 4.0, settings);
  settings.error_target_mm = 1e-4;
  const FitResult fine = fit_ball_seed(phantom.image, Vec3(0, 0, 0), 4.0, settings);
  EXPECT_LT(control_point_count(coarse.surface.model), control_point_count(fine.surface.model));
}

}  // namespace
}  // namespace pellicle
