// Line search of the region energy, its levels, and the crossing energy, on profiles made by hand.

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "pellicle/energies/crossing.h"
#include "pellicle/energies/region.h"
#include "test_surfaces.h"

namespace pellicle {
namespace {

constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

Profiles profiles_of(std::size_t n, double inside, double outside, double step,
                     const std::function<double(std::size_t, double)>& f) {
  Profiles p;
  const int before = static_cast<int>(std::lround(inside / step)),
            after = static_cast<int>(std::lround(outside / step));
  p.first = -before * step;
  p.step = step;
  p.count = before + after + 1;
  for (std::size_t i = 0; i < n; ++i) {
    for (int k = 0; k < p.count; ++k) p.values.push_back(static_cast<float>(f(i, p.position(k))));
  }
  return p;
}

// Falls linearly from `high` to `low` over `width` about `place`.
double ramp(double s, double place, double width, double high, double low) {
  return low + (high - low) * std::clamp(0.5 - (s - place) / width, 0.0, 1.0);
}

TEST(RegionTargets, find_the_half_level_of_the_edge_to_a_fraction_of_a_step) {
  RandomEngine random(21);
  std::vector<double> place(80);
  for (double& v : place) v = random.uniform(-6.0, 6.0);
  for (const double sign : {1.0, -1.0}) {
    const Profiles p = profiles_of(place.size(), 10, 10, 0.5, [&](std::size_t i, double s) {
      return 50 + sign * ramp(s, place[i], 3.0, 40, -40);
    });
    const NormalTargets t = region_targets(p, {50 + sign * 40, 50 - sign * 40, {}, {}}, 8.0);
    for (std::size_t i = 0; i < place.size(); ++i) {
      // The pull of 0.02 t^2/R shifts a minimum by 0.04 t/R over the slope of q (2/3 a mm here), at most twice that.
      EXPECT_NEAR(t.offset[i], place[i], 1e-3 + 2.0 * 0.04 * std::abs(place[i]) / 8.0 / (2.0 / 3.0));
      EXPECT_EQ(t.weight[i], 1.0);
    }
  }
}

TEST(RegionTargets, stay_within_reach) {
  const Profiles p = profiles_of(3, 10, 10, 0.5, [](std::size_t i, double s) {
    return i == 0 ? 100.0 : i == 1 ? 20.0 : ramp(s, 9.0, 1.0, 100, 20);
  });
  const NormalTargets t = region_targets(p, {100.0, 20.0, {}, {}}, 6.0);
  EXPECT_NEAR(t.offset[0], 6.0, 1e-9);   // inside as far as it looks
  EXPECT_NEAR(t.offset[1], -6.0, 1e-9);  // outside as far as it looks
  EXPECT_NEAR(t.offset[2], 6.0, 1e-9);
}

TEST(RegionTargets, thin_gaps_are_crossed_only_when_more_object_lies_beyond) {
  // Dark gap of 1 mm at +2: beyond it lies either 5 mm of object, or half a millimetre.
  const auto gap = [](std::size_t i, double s) {
    const double end = i == 0 ? 8.0 : 3.5;
    return (s < 2.0 || (s > 3.0 && s < end)) ? 100.0 : 20.0;
  };
  const NormalTargets t = region_targets(profiles_of(2, 10, 10, 0.1, gap), {100.0, 20.0, {}, {}}, 9.0);
  EXPECT_NEAR(t.offset[0], 8.0, 0.1);
  EXPECT_NEAR(t.offset[1], 2.0, 0.1);
}

TEST(RegionTargets, lie_no_further_inside_than_the_depth_and_outside_as_before) {
  // Edges from -7 to +7: those within the depth, and all outside, are found where they are.
  const auto edge = [](std::size_t i, double s) { return s < -7.0 + static_cast<double>(i) ? 100.0 : 20.0; };
  const Profiles p = profiles_of(15, 10, 10, 0.5, edge);
  const NormalTargets all = region_targets(p, {100.0, 20.0, {}, {}}, 8.0),
                      near = region_targets(p, {100.0, 20.0, {}, {}}, 8.0, 3.5);
  for (std::size_t i = 0; i < 15; ++i) {
    EXPECT_NEAR(all.offset[i], -7.0 + static_cast<double>(i), 0.5);
    EXPECT_DOUBLE_EQ(near.offset[i], all.offset[i] > -3.5 ? all.offset[i] : -3.5);
  }
}

TEST(RegionTargets, end_where_the_image_ends) {
  const auto cut = [](std::size_t i, double s) {
    if (i == 0) return s > 2.2 ? kNoValue : 100.0;         // object runs into the border
    if (i == 1) return kNoValue;                           // sample outside the image
    return s < -3.2 ? kNoValue : s < -1.0 ? 100.0 : 20.0;  // border behind
  };
  const NormalTargets t = region_targets(profiles_of(3, 10, 10, 0.5, cut), {100.0, 20.0, {}, {}}, 8.0);
  EXPECT_NEAR(t.offset[0], 2.0, 1e-9);
  EXPECT_EQ(t.weight[0], 1.0);
  EXPECT_EQ(t.weight[1], 0.0);
  EXPECT_EQ(t.offset[1], 0.0);
  EXPECT_NEAR(t.offset[2], -1.0, 0.5);
}

TEST(RegionTargets, local_levels_follow_a_drift_that_global_ones_do_not) {
  // At sample 1 all intensities are 60 % higher: the true edge at 1 mm lies above the global threshold.
  const auto drift = [](std::size_t i, double s) { return (i == 1 ? 1.6 : 1.0) * ramp(s, 1.0, 4.0, 100, 50); };
  const Profiles p = profiles_of(2, 10, 10, 0.5, drift);
  const NormalTargets local = region_targets(p, {100, 50, {100, 160}, {50, 80}}, 8.0);
  EXPECT_NEAR(local.offset[0], 1.0, 1e-3);
  EXPECT_NEAR(local.offset[1], 1.0, 1e-3);
  EXPECT_GT(region_targets(p, {100, 50, {}, {}}, 8.0).offset[1], 2.0);
}

TEST(RegionTargets, same_for_other_intensity_units_and_scaled_with_the_size) {
  RandomEngine random(22);
  std::vector<double> noise(40 * 41);
  for (double& v : noise) v = 8.0 * random.normal();
  const auto f = [&](std::size_t i, double s) {
    return ramp(s, -2.0 + 0.1 * static_cast<double>(i), 3.0, 100, 20) +
           noise[41 * i + static_cast<std::size_t>(std::lround(2 * s + 20))];
  };
  const NormalTargets a = region_targets(profiles_of(40, 10, 10, 0.5, f), {100, 20, {}, {}}, 8.0);
  const Profiles other = profiles_of(40, 30, 30, 1.5, [&](std::size_t i, double s) { return 7 * f(i, s / 3) + 100; });
  const NormalTargets b = region_targets(other, {800, 240, {}, {}}, 24.0);
  for (std::size_t i = 0; i < 40; ++i) EXPECT_NEAR(b.offset[i], 3 * a.offset[i], 1e-4);
}

struct LevelCase {
  SampleGraph graph{test::sphere_samples(2, 1.0).layout};
  std::size_t n = graph.start.size() - 1;
  NormalTargets targets{std::vector<double>(n, 0.5), std::vector<double>(n, 1.0)};
};

TEST(UpdateLevels, move_towards_what_the_bands_hold) {
  LevelCase c;
  const Profiles p = profiles_of(c.n, 10, 10, 0.5, [](std::size_t, double s) { return ramp(s, 0.5, 1.0, 90, 30); });
  Levels levels{70.0, 50.0, {}, {}};
  for (int round = 0; round < 12; ++round) {
    ASSERT_TRUE(update_levels(p, c.targets, c.graph, 1.0, true, levels.contrast(), levels));
  }
  EXPECT_NEAR(levels.inside, 90.0, 0.1);
  EXPECT_NEAR(levels.outside, 30.0, 0.1);
  ASSERT_EQ(levels.local_inside.size(), c.n);
  for (const double v : levels.local_inside) EXPECT_NEAR(v, 90.0, 0.2);
  for (const double v : levels.local_outside) EXPECT_NEAR(v, 30.0, 0.2);
}

TEST(UpdateLevels, refuse_lost_or_turned_contrast_and_leave_the_levels_alone) {
  LevelCase c;
  for (const double outside : {85.0, 89.9, 90.0, 150.0, 400.0}) {
    const Profiles p =
        profiles_of(c.n, 10, 10, 0.5, [&](std::size_t, double s) { return ramp(s, 0.5, 1.0, 90, outside); });
    Levels levels{90.0, 88.0, {1.0}, {2.0}};
    EXPECT_FALSE(update_levels(p, c.targets, c.graph, 1.0, true, 60.0, levels)) << outside;
    EXPECT_EQ(levels.inside, 90.0);
    EXPECT_EQ(levels.outside, 88.0);
    EXPECT_THAT(levels.local_inside, testing::ElementsAre(1.0));
    EXPECT_THAT(levels.local_outside, testing::ElementsAre(2.0));
  }
}

TEST(UpdateLevels, refuse_when_nothing_can_be_seen) {
  LevelCase c;
  const Profiles p = profiles_of(c.n, 10, 10, 0.5, [](std::size_t, double) { return kNoValue; });
  Levels levels{90.0, 30.0, {}, {}};
  EXPECT_FALSE(update_levels(p, c.targets, c.graph, 1.0, true, 60.0, levels));
  EXPECT_EQ(levels.inside, 90.0);
}

TEST(UpdateLevels, local_levels_keep_contrast_where_an_edge_is_missing) {
  LevelCase c;
  const Profiles p = profiles_of(c.n, 10, 10, 0.5, [](std::size_t i, double s) {
    return i < 20 ? 90.0 : i == 20 ? kNoValue : ramp(s, 0.5, 1.0, 90, 30);
  });
  Levels levels{90.0, 30.0, {}, {}};
  ASSERT_TRUE(update_levels(p, c.targets, c.graph, 1.0, true, 60.0, levels));
  for (std::size_t i = 0; i < c.n; ++i) {
    EXPECT_GE(levels.local_inside[i] - levels.local_outside[i], 0.39 * levels.contrast());
  }
}

const TissueLevels kTissue{.low = 0.0, .threshold = 10.0, .middle = 100.0};

TEST(Crossing, is_where_the_profile_falls_below_the_share_of_the_brightest) {
  // Brain of 100 up to +1.5, falling to 10 at +4.5; scalp of 120 from +6: the first crossing of 66 counts.
  const SampleGraph graph(test::sphere_samples(2, 1.0).layout);
  const std::size_t n = graph.start.size() - 1;
  const Profiles p =
      profiles_of(n, 12, 8, 0.5, [](std::size_t, double s) { return s > 6.0 ? 120.0 : ramp(s, 3.0, 3.0, 100, 10); });
  const CrossingSettings settings{.fraction = 0.66, .depth = 12, .reach = 8, .cap = 6};
  const NormalTargets t = crossing_targets(p, graph, kTissue, settings);
  const double exact = 1.5 + 3.0 * (100 - 66) / 90.0;
  for (std::size_t i = 0; i < n; ++i) {
    EXPECT_NEAR(t.offset[i], exact, 1e-4);
    EXPECT_EQ(t.weight[i], 1.0);
  }
  // Intensities times 7 plus 100.
  Profiles other = p;
  for (float& v : other.values) v = 7 * v + 100;
  const NormalTargets u = crossing_targets(other, graph, {100.0, 170.0, 800.0}, settings);
  for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(u.offset[i], exact, 1e-4);
}

TEST(Crossing, is_capped_and_silent_outside_the_image) {
  const SampleGraph graph(test::sphere_samples(2, 1.0).layout);
  const std::size_t n = graph.start.size() - 1;
  const Profiles p = profiles_of(n, 12, 5, 0.5, [](std::size_t i, double s) {
    if (i == 0) return kNoValue;
    if (i == 1) return s > 1.2 ? kNoValue : 100.0;
    return i % 2 == 0 ? 100.0 : ramp(s, -9.0, 1.0, 100, 10);
  });
  const NormalTargets t = crossing_targets(p, graph, kTissue, {});
  EXPECT_EQ(t.weight[0], 0.0);
  EXPECT_NEAR(t.offset[1], 1.0, 1e-9);  // the last sample within the image
  for (std::size_t i = 2; i < n; ++i) EXPECT_NEAR(t.offset[i], i % 2 == 0 ? 4.0 : -4.0, 1e-9);
}

TEST(Targets, unchanged_when_image_and_surface_move_together) {
  RandomEngine random(23);
  const auto ball = [](const Vec3& x) {
    return 20 + 80 * test::blurred_ball((x - Vec3(1, 0.5, -0.7)).norm(), 9.0, 1.0);
  };
  const Image<float> image = test::image_of(test::centred_grid({40, 36, 26}, {0.9, 1.0, 1.4}, test::oblique()), ball);
  const test::Samples s = test::sphere_samples(3, 8.5);
  const test::Motion motion = test::random_motion(random);
  Image<float> moved_image = image;
  moved_image.grid = test::moved(image.grid, motion);
  std::vector<Vec3> x, normal;
  for (std::size_t i = 0; i < s.x.size(); ++i) {
    x.push_back(motion(s.x[i]));
    normal.push_back(motion.turn * s.normal[i]);
  }
  const Profiles here = sample_profiles(TrilinearField(image), s.x, s.normal, 6.0, 6.0, 0.5);
  const Profiles there = sample_profiles(TrilinearField(moved_image), x, normal, 6.0, 6.0, 0.5);
  ASSERT_EQ(here.count, there.count);
  const SampleGraph graph(s.layout);
  const NormalTargets a = region_targets(here, {100, 20, {}, {}}, 5.0);
  const NormalTargets b = region_targets(there, {100, 20, {}, {}}, 5.0);
  for (std::size_t i = 0; i < s.x.size(); ++i) EXPECT_NEAR(a.offset[i], b.offset[i], 1e-4);
}

TEST(Statistics, medians_and_spread_ignore_what_is_missing) {
  EXPECT_EQ(median_of({3.0, kNoValue, 1.0, 2.0}), 2.0);
  EXPECT_EQ(median_of({4.0, 1.0, 2.0, 3.0}), 2.5);
  EXPECT_TRUE(std::isnan(median_of({})));
  EXPECT_TRUE(std::isnan(median_of({kNoValue})));
  EXPECT_EQ(quantile_of({0.0, 10.0, 20.0, 30.0, 40.0}, 0.0), 0.0);
  EXPECT_EQ(quantile_of({40.0, 0.0, 10.0, 30.0, 20.0}, 1.0), 40.0);
  EXPECT_EQ(quantile_of({40.0, 0.0, 10.0, 30.0, 20.0}, 0.3), 12.0);
  RandomEngine random(24);
  std::vector<double> values(20001);
  for (double& v : values) v = 5.0 + 3.0 * random.normal();
  EXPECT_NEAR(robust_deviation(values), 3.0, 0.1);
  const Profiles p = profiles_of(1, 4, 4, 0.5, [](std::size_t, double s) { return s > 2.2 ? kNoValue : s; });
  EXPECT_NEAR(band_median(p, 0, -3.0, -1.0), -2.0, 1e-6);
  EXPECT_NEAR(band_median(p, 0, 1.0, 4.0), 1.5, 1e-6);
  EXPECT_TRUE(std::isnan(band_median(p, 0, 3.0, 4.0)));
}

}  // namespace
}  // namespace pellicle
