// The sub-voxel localisers on profiles and images whose edge is known exactly.

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "pellicle/energies/edge.h"
#include "test_surfaces.h"

namespace pellicle {
namespace {

using test::Samples;
constexpr float kNoEdge = std::numeric_limits<float>::quiet_NaN();

// Row i holds f(i, s), s in mm.
Profiles profiles_of(std::size_t n, double reach, double step, const std::function<double(std::size_t, double)>& f) {
  Profiles p;
  const int half = static_cast<int>(std::lround(reach / step));
  p.first = -half * step;
  p.step = step;
  p.count = 2 * half + 1;
  for (std::size_t i = 0; i < n; ++i) {
    for (int k = 0; k < p.count; ++k) p.values.push_back(static_cast<float>(f(i, p.position(k))));
  }
  return p;
}

double erf_edge(double s, double place, double blur, double inside, double outside) {
  return outside + (inside - outside) * 0.5 * std::erfc((s - place) / (std::sqrt(2.0) * blur));
}

double gauss(double s, double place, double width) {
  return std::exp(-0.5 * (s - place) * (s - place) / (width * width));
}

std::vector<double> random_shifts(std::size_t n, double most) {
  RandomEngine random(11);
  std::vector<double> shift(n);
  for (double& v : shift) v = random.uniform(-most, most);
  return shift;
}

TEST(Edge, plane_is_found_at_any_sub_voxel_shift) {
  const SampleGraph graph(test::sphere_samples(3, 1.0).layout);
  const std::size_t n = graph.start.size() - 1;
  for (const double h : {1.0, 0.4}) {
    for (const double blur : {0.3, 0.5, 0.7}) {
      for (const double inside : {100.0, -40.0}) {
        const std::vector<double> shift = random_shifts(n, 0.5 * h);
        const Profiles p = profiles_of(
            n, 4.0 * h, 0.25 * h, [&](std::size_t i, double s) { return erf_edge(s, shift[i], blur * h, inside, 20); });
        const EdgeMeasurement m = measure_edge(p, graph, {.h = h});
        EXPECT_NEAR(m.median_contrast / std::abs(inside - 20), 1.0, 0.01);
        for (std::size_t i = 0; i < n; ++i) {
          EXPECT_NEAR(m.targets.offset[i], shift[i], 0.006 * h) << "blur " << blur;
          EXPECT_GT(m.targets.weight[i], 0.9);
        }
      }
    }
  }
}

TEST(Edge, plane_in_a_voxel_image_is_found_through_trilinear_sampling) {
  const Vec3 normal = Vec3(0.48, -0.6, 0.64);
  const auto plane = [&](const Vec3& x) { return erf_edge(normal.dot(x), 0.37, 0.8, 90.0, 10.0); };
  const Image<float> image = test::image_of(test::centred_grid({40, 40, 40}, {1, 1, 1}), plane);
  const SampleGraph graph(test::sphere_samples(3, 1.0).layout);
  RandomEngine random(12);
  std::vector<Vec3> x, normals(graph.start.size() - 1, normal);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const Vec3 v = test::random_vector(random, 7.0);
    x.push_back(v - normal.dot(v) * normal);  // on the plane through the origin
  }
  const Profiles p = sample_profiles(TrilinearField(image), x, normals, 4.25, 4.25, 0.25);
  const EdgeMeasurement m = measure_edge(p, graph, {.h = 1.0});
  double mean = 0.0;
  for (const double t : m.targets.offset) {
    EXPECT_NEAR(t, 0.37, 0.05);
    mean += t / static_cast<double>(x.size());
  }
  EXPECT_NEAR(mean, 0.37, 0.01);
}

TEST(Edge, sphere_is_seen_s2_over_R_inside_and_the_correction_takes_it_away) {
  for (const double radius : {8.0, 12.0, 20.0}) {
    const double blur = 0.9;
    const Samples s = test::sphere_samples(3, radius);
    const SampleGraph graph(s.layout);
    const Profiles p = profiles_of(s.x.size(), 4.0, 0.25, [&](std::size_t, double at) {
      return 20.0 + 80.0 * test::blurred_ball(radius + at, radius, blur);
    });
    EdgeMeasurement m = measure_edge(p, graph, {.h = 1.0});
    const double bias = blur * blur / radius;
    EXPECT_NEAR(m.targets.offset[0] / -bias, 1.0, 0.15) << "radius " << radius;
    m.targets.correction = curvature_correction(sum_of_curvatures(s.surface()), blur, 1.0);
    apply_correction(m.targets);
    double mean = 0.0;
    for (const double t : m.targets.offset) mean += t / static_cast<double>(s.x.size());
    EXPECT_LE(std::abs(mean), 0.15 * bias) << "radius " << radius;
  }
}

TEST(Edge, blur_is_measured_from_the_mean_profile) {
  const SampleGraph graph(test::sphere_samples(3, 1.0).layout);
  const std::size_t n = graph.start.size() - 1;
  const std::vector<double> shift = random_shifts(n, 0.4);
  for (const double blur : {0.7, 1.0}) {
    const Profiles p =
        profiles_of(n, 4.0, 0.25, [&](std::size_t i, double s) { return erf_edge(s, shift[i], blur, 100.0, 20.0); });
    EXPECT_NEAR(measure_edge(p, graph, {.h = 1.0}).blur / blur, 1.0, 0.1);
  }
}

TEST(Edge, knows_its_sign_and_leaves_out_what_it_cannot_see) {
  const SampleGraph graph(test::sphere_samples(4, 1.0).layout);
  const std::size_t n = graph.start.size() - 1;
  // Samples 0..15 (the first patch's) hit the end of the image, the rest are plain.
  const Profiles p = profiles_of(n, 4.0, 0.25, [&](std::size_t i, double s) {
    return i < 16 && s > 1.0 ? kNoEdge : erf_edge(s, 0.2, 0.6, 100.0, 20.0);
  });
  const EdgeMeasurement bright = measure_edge(p, graph, {.h = 1.0, .sign = 1});
  EXPECT_NEAR(bright.median_contrast, 80.0, 1.0);
  for (std::size_t i = 0; i < n; ++i) {
    EXPECT_TRUE(std::isfinite(bright.targets.offset[i]) && std::isfinite(bright.targets.weight[i]));
    if (i >= 16) continue;
    EXPECT_EQ(bright.targets.weight[i], 0.0);
  }
  const EdgeMeasurement dark = measure_edge(p, graph, {.h = 1.0, .sign = -1});
  EXPECT_LE(dark.median_contrast, 0.0);
  for (const double w : dark.targets.weight) EXPECT_EQ(w, 0.0);
}

TEST(Edge, same_place_for_other_intensity_units_and_scaled_with_the_size) {
  const SampleGraph graph(test::sphere_samples(3, 1.0).layout);
  const std::size_t n = graph.start.size() - 1;
  const std::vector<double> shift = random_shifts(n, 0.5);
  const auto edge = [&](std::size_t i, double s) { return erf_edge(s, shift[i], 0.6, 100.0, 20.0); };
  for (const bool ridge : {false, true}) {
    const auto value = [&](std::size_t i, double s) { return ridge ? 50.0 * gauss(s, shift[i], 1.0) : edge(i, s); };
    const double reach = ridge ? 8.0 : 4.0;
    const EdgeMeasurement a = measure_edge(profiles_of(n, reach, 0.25, value), graph, {.h = 1.0, .ridge = ridge});
    const EdgeMeasurement b = measure_edge(
        profiles_of(n, 3 * reach, 0.75, [&](std::size_t i, double s) { return 7.0 * value(i, s / 3.0) + 100.0; }),
        graph, {.h = 3.0, .ridge = ridge});
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_NEAR(b.targets.offset[i], 3.0 * a.targets.offset[i], 1e-4);
      EXPECT_NEAR(b.targets.weight[i], a.targets.weight[i], 1e-4);
    }
    EXPECT_NEAR(b.median_contrast, 7.0 * a.median_contrast, 1e-3);
  }
}

TEST(Ridge, gaussian_ridge_is_found_at_any_sub_voxel_shift_either_sign) {
  const SampleGraph graph(test::sphere_samples(3, 1.0).layout);
  const std::size_t n = graph.start.size() - 1;
  const std::vector<double> shift = random_shifts(n, 0.4);
  for (const double width : {0.8, 1.2}) {
    for (const int sign : {1, -1}) {
      const Profiles p = profiles_of(
          n, 8.0, 0.25, [&](std::size_t i, double s) { return 30 + sign * 60 * gauss(s, shift[i], width); });
      const EdgeMeasurement m = measure_edge(p, graph, {.h = 1.0, .ridge = true, .sign = sign});
      EXPECT_NEAR(m.median_contrast, 60.0, 8.0);
      for (std::size_t i = 0; i < n; ++i) {
        EXPECT_NEAR(m.targets.offset[i], shift[i], 0.04) << "width " << width << " sign " << sign;
        EXPECT_GT(m.targets.weight[i], 0.5);
      }
    }
  }
}

TEST(RidgeSearch, takes_the_nearest_of_two_membranes_and_half_trusts_blind_samples) {
  const auto ridges = [](std::size_t i, double s) {
    if (i == 5) return 10.0;
    return 10.0 + 50.0 * gauss(s, 3.0, 0.9) + 55.0 * gauss(s, -9.0, 0.9);
  };
  const Profiles p = profiles_of(60, 16.0, 0.5, ridges);
  const NormalTargets t = ridge_search(p, 1.0, 12.0, 1.0);
  for (std::size_t i = 0; i < 60; ++i) {
    if (i == 5) {
      EXPECT_EQ(t.offset[i], 0.0);
      EXPECT_LT(t.weight[i], 0.2);
    } else {
      EXPECT_NEAR(t.offset[i], 3.0, 0.26);
      EXPECT_EQ(t.weight[i], 1.0);
    }
  }
  const NormalTargets none = ridge_search(p, 1.0, 2.0, 1.0);
  for (const double v : none.offset) EXPECT_LE(std::abs(v), 2.0);
}

TEST(Outliers, count_less_the_further_out_they_are) {
  NormalTargets t{std::vector<double>(100), std::vector<double>(100, 1.0)};
  RandomEngine random(13);
  for (double& v : t.offset) v = 0.1 * random.normal();
  t.offset[0] = 0.0;
  t.offset[1] = 1.0;
  t.offset[2] = 5.0;
  NormalTargets shifted = t;
  for (double& v : shifted.offset) v += 3.0;
  downweight_outliers(1.0, t);
  downweight_outliers(1.0, shifted);
  for (std::size_t i = 0; i < t.weight.size(); ++i) EXPECT_NEAR(shifted.weight[i], t.weight[i], 1e-12);
  EXPECT_NEAR(t.weight[0], 1.0, 0.01);
  EXPECT_LT(t.weight[1], 0.5);
  EXPECT_LT(t.weight[2], 0.05);
  EXPECT_GT(t.weight[2], 0.0);
}

TEST(OffsetRows, are_the_weighted_mean_square_of_what_is_left) {
  const Samples s = test::sphere_samples(2, 10.0);
  const std::vector<double> area = sample_areas(s.layout, s.x);
  NormalTargets targets{std::vector<double>(s.x.size(), 0.5), std::vector<double>(s.x.size(), 1.0)};
  targets.weight[3] = 0.0;
  const ScalarRows rows = offset_rows(s.surface(), targets, 2.0);
  EXPECT_EQ(rows.size(), s.x.size() - 1);
  const double share = 1.0 - area[3] / sum(area);
  EXPECT_NEAR(test::energy_of(rows, s.x), 2.0 * 0.25 * share, 1e-10);
  std::vector<Vec3> arrived = s.x;
  for (std::size_t i = 0; i < s.x.size(); ++i) arrived[i] += 0.5 * s.normal[i] + 0.3 * s.normal[i].unitOrthogonal();
  EXPECT_LE(test::energy_of(rows, arrived), 1e-20);
}

}  // namespace
}  // namespace pellicle
