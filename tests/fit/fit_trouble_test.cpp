// What cannot be fitted is told, never thrown; settings that break a rule are.

#include <gmock/gmock.h>

#include <algorithm>
#include <functional>
#include <limits>

#include "fit_cases.h"
#include "pellicle/base/errors.h"
#include "pellicle/energies/energy_kinds.h"
#include "pellicle/image/resample.h"

namespace pellicle {
namespace {

using test::fit_ball_seed;
using test::one_stage;
using test::small_phantom;

const Phantom& ball() {
  static const Phantom phantom = make_phantom(small_phantom());
  return phantom;
}

TEST(FitTrouble, constant_image_has_no_contrast) {
  ImageGrid grid;
  grid.size = {32, 32, 32};
  for (const float value : {0.0F, 7.0F, -1e6F}) {
    const FitResult fit = fit_ball_seed(Image<float>(grid, value), Vec3(16, 16, 16), 5.0);
    EXPECT_EQ(fit.summary.status, FitStatus::no_contrast) << to_string(fit.summary.status);
    EXPECT_FALSE(fit.summary.reason.empty());
    EXPECT_TRUE(test::finite(fit.surface));
  }
}

TEST(FitTrouble, noise_alone_is_never_ok) {
  ImageGrid grid;
  grid.size = {40, 40, 40};
  Image<float> image(grid);
  RandomEngine random(3);
  for (float& v : image.voxels) v = static_cast<float>(50 + 10 * random.normal());
  const FitResult fit = fit_ball_seed(image, Vec3(20, 20, 20), 6.0);
  EXPECT_NE(fit.summary.status, FitStatus::ok) << "evidence " << fit.summary.evidence.score;
  EXPECT_TRUE(test::finite(fit.surface));
}

TEST(FitTrouble, seeds_outside_the_object_and_beyond_the_volume_are_data) {
  for (const auto& [centre, radius] :
       {std::pair{Vec3(18, 18, 18), 3.0}, std::pair{Vec3(23, 0, 0), 6.0}, std::pair{Vec3(-23.4, -23.4, -23.4), 2.0},
        std::pair{Vec3(200, 0, 0), 5.0}, std::pair{Vec3(0, 0, 0), 0.1}, std::pair{Vec3(0, 0, 0), 300.0}}) {
    SCOPED_TRACE(testing::Message() << "seed " << centre.transpose() << " radius " << radius);
    const FitResult fit = fit_ball_seed(ball().image, centre, radius);
    EXPECT_TRUE(test::finite(fit.surface));
    // Whatever is called well must lie along an edge: of this image only the ball's.
    if (fit.summary.status == FitStatus::ok) {
      EXPECT_LE(test::assd(fit.surface, ball().truth_surface), 1.0);
    } else {
      EXPECT_FALSE(fit.summary.reason.empty());
    }
  }
}

/// Volume that two balls of radii a and b share whose centres are d apart, over that of the smaller.
double share_of_balls(double a, double b, double d) {
  const double small = std::min(a, b);
  if (d >= a + b) return 0.0;
  if (d <= std::abs(a - b)) return 1.0;
  const double lens =
      std::numbers::pi * std::pow(a + b - d, 2) * (d * d + 2 * d * (a + b) - 3 * std::pow(a - b, 2)) / (12 * d);
  return lens / (4.0 / 3.0 * std::numbers::pi * small * small * small);
}

TEST(FitTrouble, a_surface_that_leaves_its_seed_is_not_ok) {
  bool left = false, stayed = false;
  for (const double away : {0.0, 9.0, 12.0, 14.0, 16.0}) {
    SCOPED_TRACE(away);
    const FitResult fit = fit_ball_seed(ball().image, Vec3(0, away, 0), 4.0);
    if (test::dice(fit.surface, ball().truth) < 0.95) continue;
    const double share = share_of_balls(12.0, 4.0, away);
    ASSERT_TRUE(fit.summary.seed_share.has_value());
    EXPECT_NEAR(*fit.summary.seed_share, share, 0.03);
    const bool told = fit.summary.reason.find("left its seed") != std::string::npos;
    if (share < 0.2) {
      EXPECT_NE(fit.summary.status, FitStatus::ok);
      left = left || told;
    } else if (share > 0.3) {
      EXPECT_FALSE(told) << fit.summary.reason;
      stayed = true;
    }
  }
  EXPECT_TRUE(left && stayed);
}

// A search over the whole reach would send each side of the ball past the other.
TEST(FitTrouble, ball_twice_as_wide_as_a_rod_shrinks_onto_it_and_is_not_turned_inside_out) {
  PhantomSettings s = small_phantom("ellipsoid");
  s.radius = {16.0, 4.0, 4.0};
  const Phantom phantom = make_phantom(s);
  for (const ModelKind kind : {ModelKind::normal, ModelKind::spline, ModelKind::catmull_clark}) {
    SCOPED_TRACE(static_cast<int>(kind));
    FitOptions settings =
        one_stage({.detail = 1,
                   .energies = {{energy::region, 1.0}, {energy::bending, 1e-3}, {energy::spacing, 0.05}},
                   .reach = 16.0});
    settings.model.kind = kind;
    const FitResult fit = fit_ball_seed(phantom.image, Vec3::Zero(), 8.0, settings);
    EXPECT_EQ(fit.summary.stages.back().reason(), "converged");
    EXPECT_GE(test::dice(fit.surface, phantom.truth), 0.9) << to_string(fit.summary.status);
  }
}

TEST(FitTrouble, object_cut_by_the_border_is_right_within_the_volume) {
  PhantomSettings s = small_phantom();
  s.center = Vec3(17, 0, 0);  // 5 of 24 voxels beyond the border
  const Phantom phantom = make_phantom(s);
  const FitResult fit = fit_ball_seed(phantom.image, Vec3(15, 0, 0), 5.0);
  EXPECT_TRUE(test::finite(fit.surface));
  EXPECT_GE(test::dice(fit.surface, phantom.truth), 0.93) << to_string(fit.summary.status);
}

/// A ball of radius 9 about (0,0,-8) that a bridge of radius 3 joins to a slab as bright as itself, a third of the
/// volume.
struct Joined {
  Image<float> image = ball().image;
  Image<std::uint8_t> alone{image.grid}, with_bridge{image.grid};
  explicit Joined(double noise) {
    RandomEngine random(1);
    for (int k = 0; k < 48; ++k) {
      for (int j = 0; j < 48; ++j) {
        for (int i = 0; i < 48; ++i) {
          const Vec3 x = image.grid.world_from_index(Vec3(i, j, k));
          const bool in_ball = (x - Vec3(0, 0, -8)).norm() < 9.0;
          const bool in_bridge = x.z() > -8.0 && x.z() <= 9.0 && x.head<2>().norm() < 4.0;
          alone.at(i, j, k) = in_ball ? 1 : 0;
          with_bridge.at(i, j, k) = in_ball || in_bridge ? 1 : 0;
          image.at(i, j, k) = in_ball || (x.z() > -8.0 && x.head<2>().norm() < 3.0) || x.z() > 8.0 ? 100.0F : 20.0F;
        }
      }
    }
    image = gaussian_smooth(std::move(image), 1.0);
    for (float& v : image.voxels) v += static_cast<float>(noise * random.normal());
  }
};

TEST(FitTrouble, object_joined_to_a_slab_is_held_or_the_leak_is_told) {
  for (const double noise : {0.0, 16.0}) {
    const Joined joined(noise);
    for (const double radius : {4.0, 8.0}) {
      const FitResult fit = fit_ball_seed(joined.image, Vec3(0, 0, -9), radius);
      if (fit.summary.status != FitStatus::ok) continue;
      const Image<std::uint8_t> mask = rasterize_mask(tessellate(fit.surface, 4), joined.image.grid);
      double voxels = 0.0, outside = 0.0;
      for (std::size_t i = 0; i < mask.voxels.size(); ++i) {
        voxels += mask.voxels[i];
        outside += mask.voxels[i] != 0 && joined.with_bridge.voxels[i] == 0 ? 1.0 : 0.0;
      }
      const testing::Message what = testing::Message() << "noise " << noise << ", seed radius " << radius
                                                       << ", evidence " << fit.summary.evidence.score;
      EXPECT_LE(outside / voxels, 0.1) << what;                     // no leak
      EXPECT_GE(overlap_of(joined.alone, mask).dice, 0.6) << what;  // and more than a core of it
    }
  }
}

TEST(FitTrouble, surfaces_that_shrink_to_nothing_are_told) {
  // The volume prior asks for a thousandth of a voxel.
  FitOptions settings =
      one_stage({.name = "shrink", .detail = 0, .energies = {{energy::bending, 1e-6}}, .max_steps = 40});
  settings.target_volume_ml = 1e-6;
  settings.volume_weight = 1e4;
  const FitResult fit = fit_ball_seed(ball().image, Vec3(0, 0, 0), 6.0, settings);
  EXPECT_NE(fit.summary.status, FitStatus::ok);
  EXPECT_TRUE(test::finite(fit.surface));
}

TEST(FitHypotheses, polarity_is_honoured_when_told) {
  for (const Polarity polarity : {Polarity::bright, Polarity::dark}) {
    FitOptions settings;
    settings.polarity = polarity;
    settings.similarity = false;
    const FitResult fit = fit_ball_seed(ball().image, Vec3(0, 0, 0), 6.0, settings);
    if (polarity == Polarity::bright) {
      EXPECT_EQ(fit.summary.status, FitStatus::ok);
      EXPECT_EQ(fit.summary.polarity, Polarity::bright);
    } else {
      EXPECT_NE(fit.summary.status, FitStatus::ok);  // the ball is bright: no dark object here
    }
  }
}

TEST(FitHypotheses, several_seeds_are_all_in_the_report_until_one_decides) {
  const std::vector<Seed> seeds{SeedSphere{Vec3(-19, -19, -19), 3.0}, SeedSphere{Vec3(1, 1, 0), 5.0}};
  const FitResult fit = fit_surface({ball().image, seeds}, {});
  EXPECT_EQ(fit.summary.status, FitStatus::ok) << fit.summary.reason;
  EXPECT_LE(test::assd(fit.surface, ball().truth_surface), 0.1);
  ASSERT_FALSE(fit.summary.hypotheses.empty());
  for (const HypothesisSummary& h : fit.summary.hypotheses) EXPECT_THAT(h.name, testing::StartsWith("seed "));
}

TEST(FitOptions, detail_limits_the_control_points) {
  for (const auto& [detail, points] : {std::pair{0, 4}, std::pair{1, 10}, std::pair{2, 34}}) {
    FitOptions settings;
    settings.detail = detail;
    const FitResult fit = fit_ball_seed(ball().image, Vec3(1, 0, 0), 6.0, settings);
    EXPECT_LE(control_point_count(fit.surface.model), points);
    EXPECT_TRUE(detail == 2 || control_point_count(fit.surface.model) == points);
    EXPECT_LE(test::assd(fit.surface, ball().truth_surface), 0.1) << points << " control points make a sphere";
  }
}

TEST(FitOptions, every_given_stage_runs_though_none_measures_edges) {
  FitOptions options;
  options.similarity = false;
  for (int detail = 0; detail <= 2; ++detail) {
    options.stages.push_back({.name = "region",
                              .detail = detail,
                              .energies = {{energy::region, 1.0}, {energy::bending, 1e-3}, {energy::spacing, 0.05}},
                              .max_steps = 5});
  }
  const FitResult fit = fit_ball_seed(ball().image, Vec3(0, 0, 0), 6.0, options);
  EXPECT_EQ(control_point_count(fit.surface.model), 34);
}

TEST(FitOptions, progress_runs_up_and_says_what_is_done) {
  double last = -1.0;
  int calls = 0;
  Observer observer;
  observer.progress = [&](double fraction, const std::string& what) {
    EXPECT_GE(fraction, last);
    EXPECT_LE(fraction, 1.0);
    EXPECT_FALSE(what.empty());
    last = fraction;
    ++calls;
  };
  fit_surface({ball().image, {Seed(SeedSphere{Vec3(0, 0, 0), 6.0})}}, {}, observer);
  EXPECT_GT(calls, 0);
}

// Message and setting that breaks a rule.
TEST(StageValidate, names_stage_key_and_value) {
  static constexpr double kInf = std::numeric_limits<double>::infinity();
  const std::vector<std::pair<std::function<void(Stage&)>, std::string>> wrong{
      {[](Stage& s) { s.detail = -1; }, "detail"},
      {[](Stage& s) { s.detail = 9; }, "detail"},
      {[](Stage& s) { s.resolution = -1.0; }, "resolution"},
      {[](Stage& s) { s.smoothing = -0.5; }, "smoothing"},
      {[](Stage& s) { s.smoothing = std::nan(""); }, "smoothing"},
      {[](Stage& s) { s.reach = 0.0; }, "reach"},
      {[](Stage& s) { s.max_steps = -1; }, "max_steps"},
      {[](Stage& s) { s.tolerance = -1e-3; }, "tolerance"},
      {[](Stage& s) { s.tolerance = kInf; }, "tolerance"},
      {[](Stage& s) {
         s.energies = {{energy::region, -1.0}};
       },
       "region"},
      {[](Stage& s) {
         s.energies = {{energy::edge, std::nan("")}};
       },
       "edge"},
      {[](Stage& s) {
         s.energies = {{energy::inflation, kInf}};
       },
       "inflation"},
  };
  for (const auto& [change, key] : wrong) {
    Stage stage;
    stage.name = "mine";
    change(stage);
    try {
      stage.validate();
      ADD_FAILURE() << key << " was let through";
    } catch (const UsageError& e) {
      EXPECT_THAT(e.what(), testing::HasSubstr(key));
      EXPECT_THAT(e.what(), testing::HasSubstr("mine"));
      EXPECT_EQ(e.category(), ErrorCategory::usage);
    }
  }
  EXPECT_NO_THROW((Stage{.energies = {{energy::inflation, -1.0}}}.validate()));
  for (const EnergyKind& kind : energy_kinds()) EXPECT_NO_THROW((Stage{.energies = {{kind, 1.0}}}.validate()));
}

TEST(FitOptions, unknown_energy_and_bad_values_are_usage_errors) {
  const auto expect_refused = [](const FitOptions& settings, const std::string& what) {
    EXPECT_THROW(settings.validate(), UsageError) << what;
    EXPECT_THROW(fit_ball_seed(ball().image, Vec3(0, 0, 0), 6.0, settings), UsageError) << what;
  };
  FitOptions settings;
  settings.energies = {{energy::region, -1.0}};
  expect_refused(settings, "negative weight");
  settings = {};
  settings.detail = 7;
  expect_refused(settings, "detail");
  settings = {};
  settings.target_volume_ml = 0.0;
  expect_refused(settings, "target volume");
  settings = {};
  settings.smoothing_mm = -1.0;
  expect_refused(settings, "smoothing");
  settings = {};
  settings.max_iterations = -1;
  expect_refused(settings, "iterations");
  settings = {};
  settings.tolerance = std::nan("");
  expect_refused(settings, "tolerance");
  for (const StartRule rule : {StartRule::automatic, StartRule::sphere, StartRule::rays, StartRule::head}) {
    settings = {};
    settings.start_rule = rule;
    for (const StartKind start : {StartKind::ball, StartKind::surface, StartKind::outlined, StartKind::many}) {
      for (const Stage& stage : plan_for(settings, start, true).first.stages) EXPECT_NO_THROW(stage.validate());
    }
  }
}

}  // namespace
}  // namespace pellicle
