// Stages of scalar energies (L-BFGS): each moves the surface the way it should.

#include <gmock/gmock.h>

#include "fit_cases.h"
#include "pellicle/energies/energy_kinds.h"

namespace pellicle {
namespace {

using test::fit_ball_seed;
using test::one_stage;
using test::small_phantom;

const Phantom& noiseless_ball() {
  static const Phantom phantom = make_phantom(small_phantom());  // radius 12, bright
  return phantom;
}
const Phantom& dark_ball() {
  static const Phantom phantom = [] {
    PhantomSettings s = small_phantom();
    std::swap(s.inside, s.outside);
    return make_phantom(s);
  }();
  return phantom;
}

Stage gradient_stage(EnergyWeights energies) {
  energies[energy::bending] = 1e-4;
  energies[energy::spacing] = 0.05;
  return {.name = "gradient",
          .detail = 1,
          .energies = std::move(energies),
          .resolution = 1.0,
          .smoothing = 1.0,
          .max_steps = 20,
          .tolerance = 0.01,
          .solver = Solver::gradient};
}

TEST(ScalarStages, region_integral_grows_and_shrinks_to_the_edge) {
  for (const Phantom* phantom : {&noiseless_ball(), &dark_ball()}) {
    for (const double start : {8.0, 15.0}) {
      const FitResult fit =
          fit_ball_seed(phantom->image, Vec3(0.5, 0, 0), start, one_stage(gradient_stage({{energy::region, 1.0}})));
      EXPECT_NEAR(test::radius(fit.surface), 12.0, 0.5) << "from " << start << " " << fit.summary.reason;
      ASSERT_EQ(fit.summary.stages.size(), 1U);
      EXPECT_THAT(fit.summary.stages[0].energy_after, testing::Contains(testing::Key("region")));
    }
  }
}

TEST(ScalarStages, flux_draws_the_surface_onto_the_edge) {
  Stage stage = gradient_stage({{energy::flux, 1.0}});
  stage.smoothing = 2.0;
  for (const Phantom* phantom : {&noiseless_ball(), &dark_ball()}) {
    for (const double start : {10.5, 13.5}) {
      const FitResult fit = fit_ball_seed(phantom->image, Vec3(0, 0, 0), start, one_stage(stage));
      EXPECT_LE(std::abs(test::radius(fit.surface) - 12.0), 0.5 * std::abs(start - 12.0)) << "from " << start;
    }
  }
}

TEST(ScalarStages, volume_prior_pulls_to_its_target_exactly_when_alone) {
  for (const double target : {4.0, 10.0}) {
    FitOptions settings = one_stage(gradient_stage({}));
    settings.target_volume_ml = target;
    const FitResult fit = fit_ball_seed(noiseless_ball().image, Vec3(0, 0, 0), 11.0, settings);
    EXPECT_NEAR(test::volume(fit.surface) / (1000.0 * target), 1.0, 0.01);
  }
}

TEST(ScalarStages, volume_prior_and_edge_meet_in_between) {
  FitOptions settings;
  settings.detail = 1;
  const double plain = test::volume(fit_ball_seed(noiseless_ball().image, Vec3(0, 0, 0), 8.0, settings).surface);
  settings.target_volume_ml = 1.3e-3 * plain;
  double last = plain;
  for (const double weight : {0.3, 3.0, 30.0}) {
    settings.volume_weight = weight;
    const double v = test::volume(fit_ball_seed(noiseless_ball().image, Vec3(0, 0, 0), 8.0, settings).surface);
    EXPECT_GT(v, last - 1e-3 * plain) << "weight " << weight;  // once at the target, steps end on either side of it
    EXPECT_LT(v, 1.01 * 1.3 * plain);
    last = v;
  }
}

TEST(ScalarStages, inflation_blows_up_and_its_negative_deflates) {
  // Against line-search targets, weight w holds a sphere about w h/2 beyond them.
  std::vector<double> radius;
  for (const double weight : {-0.3, 0.0, 0.3}) {
    Stage stage = gradient_stage({{energy::region, 1.0}, {energy::inflation, weight}});
    stage.solver = Solver::least_squares;
    radius.push_back(
        test::radius(fit_ball_seed(noiseless_ball().image, Vec3(0, 0, 0), 11.5, one_stage(stage)).surface));
  }
  EXPECT_NEAR(radius[1], 12.0, 0.35);  // the smoothed image is seen s^2/R inside
  EXPECT_NEAR(radius[2] - radius[1], 0.15, 0.08);
  EXPECT_NEAR(radius[1] - radius[0], 0.15, 0.08);
}

TEST(ScalarStages, inflation_alone_runs_and_is_told) {
  for (const double weight : {-1.0, 1.0}) {
    const FitResult fit = fit_ball_seed(noiseless_ball().image, Vec3(0, 0, 0), 8.0,
                                        one_stage(gradient_stage({{energy::inflation, weight}})));
    EXPECT_NE(fit.summary.status, FitStatus::ok);
    EXPECT_TRUE(test::finite(fit.surface));
    EXPECT_LE(test::radius(fit.surface), 60.0);  // steps are bounded: caught about where it left the volume
  }
}

}  // namespace
}  // namespace pellicle
