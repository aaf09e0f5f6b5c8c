// Flux, region integral, volume prior, inflation: derivatives, the divergence theorem, invariances.

#include <gmock/gmock.h>

#include <array>
#include <numbers>

#include "pellicle/energies/flux.h"
#include "pellicle/energies/inflation.h"
#include "pellicle/energies/region.h"
#include "pellicle/energies/volume.h"
#include "pellicle/image/resample.h"
#include "pellicle/raster/rasterize.h"
#include "test_surfaces.h"

namespace pellicle {
namespace {

using test::Motion;
using test::Samples;

// A smooth object without symmetry, contrast 80 on 20.
double lump(const Vec3& x) {
  const double r = x.cwiseQuotient(Vec3(11.0, 9.0, 8.0)).norm() + 0.03 * x.x() * x.y() / 9.0;
  return 20.0 + 80.0 / (1.0 + std::exp(4.0 * (r - 1.0)));
}

struct ScalarCase {
  Image<float> image;
  Samples samples;
};

ScalarCase lump_case() {
  RandomEngine random(7);
  return {test::image_of(test::centred_grid({30, 34, 22}, {1.1, 0.9, 1.5}, test::oblique()), lump),
          test::crumpled_sphere(2, 8.0, 0.8, random)};
}

struct Evaluated {
  double energy = 0.0;
  std::vector<Vec3> dx, da;
};

Evaluated evaluate_flux(const Image<float>& image, const SampleLayout& layout, const std::vector<Vec3>& x,
                        double scale) {
  const auto images = gradient_images(image);
  const std::array<CubicField, 3> fields{CubicField(images[0]), CubicField(images[1]), CubicField(images[2])};
  Evaluated e{0.0, std::vector<Vec3>(x.size(), Vec3::Zero()), std::vector<Vec3>(x.size(), Vec3::Zero())};
  e.energy = flux(fields, scale, x, area_vectors(layout, x), e.dx, e.da);
  return e;
}

Evaluated evaluate_preintegrated_flux(const Image<float>& image, const SampleLayout& layout, const std::vector<Vec3>& x,
                                      double scale) {
  const Image<float> g = flux_antiderivative(image);
  Evaluated e{0.0, std::vector<Vec3>(x.size(), Vec3::Zero()), std::vector<Vec3>(x.size(), Vec3::Zero())};
  e.energy = region_integral(CubicField(g), image.grid.direction.col(0), scale, x, area_vectors(layout, x), e.dx, e.da);
  return e;
}

Evaluated evaluate_region(const Image<float>& potential, const SampleLayout& layout, const std::vector<Vec3>& x,
                          double scale) {
  const Image<float> q = antiderivative(potential);
  Evaluated e{0.0, std::vector<Vec3>(x.size(), Vec3::Zero()), std::vector<Vec3>(x.size(), Vec3::Zero())};
  e.energy =
      region_integral(CubicField(q), potential.grid.direction.col(0), scale, x, area_vectors(layout, x), e.dx, e.da);
  return e;
}

TEST(Flux, gradient_is_the_derivative) {
  const ScalarCase c = lump_case();
  const auto images = gradient_images(c.image);
  const std::array<CubicField, 3> fields{CubicField(images[0]), CubicField(images[1]), CubicField(images[2])};
  const auto energy = [&](const auto& x, const auto& a, auto& dx, auto& da) {
    return flux(fields, 0.37, x, a, dx, da);
  };
  EXPECT_EQ(test::gradient_fault(c.samples, energy, 1e-4), "");
}

TEST(PreintegratedFlux, gradient_is_the_derivative) {
  const ScalarCase c = lump_case();
  const Image<float> g = flux_antiderivative(c.image);
  const CubicField field(g);
  const Vec3 axis = c.image.grid.direction.col(0);
  const auto energy = [&](const auto& x, const auto& a, auto& dx, auto& da) {
    return region_integral(field, axis, 0.37, x, a, dx, da);
  };
  EXPECT_EQ(test::gradient_fault(c.samples, energy, 1e-4), "");
}

TEST(RegionIntegral, gradient_is_the_derivative) {
  const ScalarCase c = lump_case();
  const Image<float> q = antiderivative(region_potential(c.image, 100.0, 20.0));
  const CubicField field(q);
  const Vec3 axis = c.image.grid.direction.col(0);
  const auto energy = [&](const auto& x, const auto& a, auto& dx, auto& da) {
    return region_integral(field, axis, 0.01, x, a, dx, da);
  };
  EXPECT_EQ(test::gradient_fault(c.samples, energy, 1e-4), "");
}

TEST(VolumePrior, gradient_is_the_derivative) {
  const ScalarCase c = lump_case();
  const SampleLayout& layout = c.samples.layout;
  const auto energy = [&](const auto& x, const auto& a, auto& dx, auto&) {
    return volume_prior(facet_volume(layout, x), 1.02, 1500.0, 0.7, a, dx);
  };
  EXPECT_EQ(test::gradient_fault(c.samples, energy, 1e-6), "");
}

TEST(Inflation, gradient_is_the_derivative) {
  const ScalarCase c = lump_case();
  const SampleLayout& layout = c.samples.layout;
  const auto energy = [&](const auto& x, const auto& a, auto& dx, auto&) {
    return inflation(facet_volume(layout, x), 2000.0, 800.0, 1.2, -0.7, a, dx);
  };
  EXPECT_EQ(test::gradient_fault(c.samples, energy, 1e-6), "");
}

// Derivatives are added to what other energies have left there.
TEST(ScalarEnergies, add_to_the_derivatives) {
  const ScalarCase c = lump_case();
  const std::vector<Vec3>& x = c.samples.x;
  const std::vector<Vec3> a = area_vectors(c.samples.layout, x);
  const Image<float> q = antiderivative(region_potential(c.image, 100.0, 20.0));
  const auto images = gradient_images(c.image);
  const std::array<CubicField, 3> fields{CubicField(images[0]), CubicField(images[1]), CubicField(images[2])};
  const Vec3 left(1.0, 2.0, 3.0), zero = Vec3::Zero();
  const auto run = [&](const Vec3& start, std::vector<Vec3>& dx, std::vector<Vec3>& da) {
    dx.assign(x.size(), start);
    da.assign(x.size(), start);
    flux(fields, 0.3, x, a, dx, da);
    region_integral(CubicField(q), Vec3::UnitX(), 0.02, x, a, dx, da);
    volume_prior(2000.0, 1.0, 1500.0, 1.0, a, dx);
    inflation(2000.0, 1900.0, 800.0, 1.0, 1.0, a, dx);
  };
  std::vector<Vec3> dx, da, dx_left, da_left;
  run(zero, dx, da);
  run(left, dx_left, da_left);
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_LE((dx_left[i] - dx[i] - left).norm(), 1e-12);
    EXPECT_LE((da_left[i] - da[i] - left).norm(), 1e-12);
  }
}

TEST(Flux, of_a_quadratic_is_its_laplacian_times_the_volume) {
  // Central differences and cubic interpolation are exact here, and the facet sum is exact for linear fields.
  const Samples s = lump_case().samples;
  const ImageGrid grid = test::centred_grid({40, 46, 30}, {1.1, 0.9, 1.5}, test::oblique());
  const Image<float> image = test::image_of(grid, [](const Vec3& x) {
    return 3.0 + 2.0 * x.x() - x.z() + 0.05 * x.x() * x.x() + 0.11 * x.y() * x.y() - 0.03 * x.z() * x.z() +
           0.2 * x.x() * x.y();
  });
  const double volume = facet_volume(s.layout, s.x);
  EXPECT_NEAR(evaluate_flux(image, s.layout, s.x, 1.0).energy / (0.26 * volume), 1.0, 1e-4);
  EXPECT_NEAR(evaluate_preintegrated_flux(image, s.layout, s.x, 1.0).energy / (0.26 * volume), 1.0, 1e-4);
}

TEST(PreintegratedFlux, equals_the_flux_through_the_surface_to_second_order) {
  // A smooth image and a surface, both without symmetry, on oblique uneven grids; samples far denser than voxels, so
  // that the grids alone tell the two apart. Both the energies and their derivatives along a motion agree.
  Samples s = test::sphere_samples(6, 1.0, Vec3::Zero(), StartSolid::octahedron);
  for (Vec3& p : s.x) p = Vec3(0.7, -0.4, 0.9) + Vec3(9.5, 8.0, 7.0).cwiseProduct(p) * (1.0 + 0.1 * p.x() * p.y());
  const auto smooth = [](const Vec3& x) {
    return 100.0 / (1.0 + std::exp((x.cwiseQuotient(Vec3(1.3, 1.0, 0.9)).norm() - 8.0) / 2.0)) + 2.0 * x.y();
  };
  const auto swelling = [&s](const Evaluated& e) {  // dE/dt for x -> (1 + t) x
    std::vector<Vec3> dx = e.dx;
    pull_back_area_vectors(s.layout, s.x, e.da, dx);
    double sum = 0.0;
    for (std::size_t i = 0; i < dx.size(); ++i) sum += dx[i].dot(s.x[i]);
    return sum;
  };
  std::vector<double> error, error_of_slope;
  for (const double h : {2.0, 1.0, 0.5}) {
    const Index3 size{static_cast<int>(std::lround(36.0 / h)), static_cast<int>(std::lround(44.0 / h)),
                      static_cast<int>(std::lround(24.0 / h))};
    const Image<float> image =
        test::image_of(test::centred_grid(size, Vec3(1.0, 0.8, 1.4) * h, test::oblique()), smooth);
    const Evaluated a = evaluate_flux(image, s.layout, s.x, 1.0);
    const Evaluated b = evaluate_preintegrated_flux(image, s.layout, s.x, 1.0);
    error.push_back(std::abs(b.energy / a.energy - 1.0));
    error_of_slope.push_back(std::abs(swelling(b) - swelling(a)) / std::abs(a.energy));
  }
  for (const auto* e : {&error, &error_of_slope}) {
    EXPECT_LE((*e)[1], 0.36 * (*e)[0]) << (*e)[0] << " " << (*e)[1] << " " << (*e)[2];
    EXPECT_LE((*e)[2], 0.32 * (*e)[1]) << (*e)[0] << " " << (*e)[1] << " " << (*e)[2];
    EXPECT_LE((*e)[2], 0.01);
  }
}

TEST(Flux, equals_the_integral_of_the_laplacian_to_second_order) {
  // Gaussian bump of width 6 about the origin; for a ball about the origin both sides have closed form 4 pi R^2 I'(R).
  const double width = 6.0, radius = 7.0;
  const Samples s = test::sphere_samples(6, radius);
  const double slope = -radius / (width * width) * std::exp(-0.5 * radius * radius / (width * width));
  const double exact = 4.0 * std::numbers::pi * radius * radius * slope;
  std::vector<double> error, preintegrated;
  for (const double h : {3.0, 1.5, 0.75}) {
    const int n = static_cast<int>(std::lround(24.0 / h)) + 2;
    const ImageGrid grid = test::centred_grid({n, n, n}, {h, h, h}, test::oblique());
    const Image<float> image =
        test::image_of(grid, [&](const Vec3& x) { return std::exp(-0.5 * x.squaredNorm() / (width * width)); });
    error.push_back(std::abs(evaluate_flux(image, s.layout, s.x, 1.0).energy / exact - 1.0));
    preintegrated.push_back(std::abs(evaluate_preintegrated_flux(image, s.layout, s.x, 1.0).energy / exact - 1.0));
  }
  for (const auto* e : {&error, &preintegrated}) {
    EXPECT_LE((*e)[1], 0.32 * (*e)[0]) << (*e)[0] << " " << (*e)[1] << " " << (*e)[2];
    EXPECT_LE((*e)[2], 0.32 * (*e)[1]) << (*e)[0] << " " << (*e)[1] << " " << (*e)[2];
    EXPECT_LE((*e)[2], 0.01);
  }
}

TEST(Flux, along_an_ideal_edge_is_minus_04_of_a_squared_voxel_whatever_units) {
  // The header's claim: p h^2 s/(c A) sum grad . a is about -0.4 h^2 along a step smoothed by s.
  const double radius = 12.0, h = 1.0, s = 1.0;
  for (const auto& [inside, outside] : {std::pair{100.0, 20.0}, std::pair{-3.0, 4.0}}) {
    const double a = inside, b = outside;
    const Image<float> image = test::image_of(test::centred_grid({36, 36, 36}, {h, h, h}), [&](const Vec3& x) {
      return b + (a - b) * test::blurred_ball(x.norm(), radius, s);
    });
    const Samples surface = test::sphere_samples(4, radius);
    const double area = sum(sample_areas(surface.layout, surface.x));
    const double polarity = a > b ? 1.0 : -1.0;
    const double scale = polarity * h * h * s / (std::abs(a - b) * area);
    EXPECT_NEAR(evaluate_flux(image, surface.layout, surface.x, scale).energy, -0.4, 0.06);
  }
}

TEST(RegionPotential, is_minus_one_inside_plus_one_outside_for_either_polarity) {
  const ImageGrid grid = test::centred_grid({4, 1, 1}, {1, 1, 1});
  Image<float> image(grid);
  image.voxels = {100.0F, 20.0F, 60.0F, 500.0F};
  EXPECT_THAT(region_potential(image, 100.0, 20.0).voxels,
              testing::Pointwise(testing::FloatNear(1e-6F), {-1.0F, 1.0F, 0.0F, -1.0F}));
  EXPECT_THAT(region_potential(image, 20.0, 100.0).voxels,
              testing::Pointwise(testing::FloatNear(1e-6F), {1.0F, -1.0F, 0.0F, 1.0F}));
}

TEST(RegionIntegral, of_a_constant_is_the_enclosed_volume) {
  const Samples s = lump_case().samples;
  const Image<float> ones(test::centred_grid({40, 46, 30}, {1.1, 0.9, 1.5}, test::oblique()), 1.0F);
  EXPECT_NEAR(evaluate_region(ones, s.layout, s.x, 1.0).energy / facet_volume(s.layout, s.x), 1.0, 1e-5);
}

TEST(RegionIntegral, by_surface_equals_the_sum_over_voxels_to_second_order) {
  // The other side is the sum of the potential over voxels, each counted with its exact share inside the facets.
  Samples s = test::sphere_samples(7, 1.0, Vec3::Zero(), StartSolid::octahedron);
  for (Vec3& p : s.x) p = Vec3(0.7, -0.4, 0.9) + Vec3(9.5, 8.0, 7.0).cwiseProduct(p) * (1.0 + 0.1 * p.x() * p.y());
  const TriangleMesh mesh{s.x, s.layout.triangles, {}};
  const auto potential = [](const Vec3& x) {
    return std::tanh(((x - Vec3(1, 0, -1)).norm() - 8.0) / 3.0) + 0.3 * x.y() / 8.0;
  };
  std::vector<double> error;
  for (const double h : {2.0, 1.0, 0.5}) {
    const int n = static_cast<int>(std::lround(28.0 / h));
    const Image<float> q = test::image_of(test::centred_grid({n, n, n}, {h, h, h}, test::oblique()), potential);
    const Image<float> share = rasterize_partial_volume(mesh, q.grid);
    double voxels = 0.0;
    for (std::size_t i = 0; i < q.voxels.size(); ++i) voxels += q.voxels[i] * share.voxels[i];
    voxels *= q.grid.voxel_volume();
    error.push_back(std::abs(evaluate_region(q, s.layout, s.x, 1.0).energy - voxels) / facet_volume(s.layout, s.x));
  }
  EXPECT_LE(error[1], 0.4 * error[0]) << error[0] << " " << error[1] << " " << error[2];
  EXPECT_LE(error[2], 0.4 * error[1]) << error[0] << " " << error[1] << " " << error[2];
  EXPECT_LE(error[2], 5e-4);
}

TEST(ScalarEnergies, unchanged_when_image_and_surface_move_together) {
  const ScalarCase c = lump_case();
  RandomEngine random(9);
  const Motion motion = test::random_motion(random);
  ScalarCase m = c;
  m.image.grid = test::moved(c.image.grid, motion);
  for (Vec3& x : m.samples.x) x = motion(x);
  const Evaluated flux_here = evaluate_flux(c.image, c.samples.layout, c.samples.x, 1.0);
  const Evaluated flux_there = evaluate_flux(m.image, m.samples.layout, m.samples.x, 1.0);
  EXPECT_NEAR(flux_there.energy / flux_here.energy, 1.0, 1e-5);
  const Image<float> q = region_potential(c.image, 100.0, 20.0), q_there = region_potential(m.image, 100.0, 20.0);
  const Evaluated region_here = evaluate_region(q, c.samples.layout, c.samples.x, 1.0);
  const Evaluated region_there = evaluate_region(q_there, m.samples.layout, m.samples.x, 1.0);
  EXPECT_NEAR(region_there.energy / region_here.energy, 1.0, 1e-6);
  for (std::size_t i = 0; i < c.samples.x.size(); ++i) {
    EXPECT_LE((flux_there.dx[i] - motion.turn * flux_here.dx[i]).norm(), 2e-4 * (1.0 + flux_here.dx[i].norm()));
    EXPECT_LE((region_there.dx[i] - motion.turn * region_here.dx[i]).norm(), 1e-4 * (1.0 + region_here.dx[i].norm()));
  }
}

TEST(ScalarEnergies, unchanged_by_intensity_units_and_scaled_by_the_square_of_the_size) {
  const ScalarCase c = lump_case();
  const double k = 3.0, h = c.image.grid.mean_spacing();
  const double area = sum(sample_areas(c.samples.layout, c.samples.x));
  ScalarCase other = c;  // x -> 7 x + 100, and everything three times as large
  for (float& v : other.image.voxels) v = 7.0F * v + 100.0F;
  other.image.grid.spacing *= k;
  other.image.grid.origin_in_world *= k;
  for (Vec3& x : other.samples.x) x *= k;
  const double flux_here = evaluate_flux(c.image, c.samples.layout, c.samples.x, h * h * h / (80.0 * area)).energy;
  const double flux_there =
      evaluate_flux(other.image, other.samples.layout, other.samples.x, k * h * h * h / (560.0 * area)).energy;
  EXPECT_NEAR(flux_there / flux_here, k * k, 1e-3);
  const double region_here =
      evaluate_region(region_potential(c.image, 100.0, 20.0), c.samples.layout, c.samples.x, h / area).energy;
  const double region_there = evaluate_region(region_potential(other.image, 800.0, 240.0), other.samples.layout,
                                              other.samples.x, h / (k * area))
                                  .energy;
  EXPECT_NEAR(region_there / region_here, k * k, 1e-3);
}

TEST(VolumePrior, of_a_sphere_is_half_the_squared_error_of_its_radius) {
  std::vector<Vec3> none;
  const auto ball = [](double r) { return 4.0 / 3.0 * std::numbers::pi * r * r * r; };
  EXPECT_NEAR(volume_prior(ball(10.1), 1.0, ball(10.0), 1.0, {}, none), 0.5 * 0.1 * 0.1, 2e-4);
  EXPECT_NEAR(volume_prior(ball(20.2), 1.0, ball(20.0), 1.0, {}, none), 0.5 * 0.2 * 0.2, 8e-4);
  EXPECT_LE(volume_prior(ball(9.0) / 1.05, 1.05, ball(9.0), 3.0, {}, none), 1e-20);
}

TEST(Inflation, is_bounded_and_best_at_four_voxels_outward_or_inward) {
  std::vector<Vec3> none;
  const double h = 1.5, area = 1000.0, volume = 3000.0;
  for (const double weight : {0.3, -0.3, 2.0}) {
    const auto energy = [&](double move) { return inflation(volume + area * move, volume, area, h, weight, {}, none); };
    const double best = weight > 0.0 ? 4.0 * h : -4.0 * h;
    EXPECT_LT(energy(best), 0.0);
    for (const double move : {-1e6, -10.0, 0.0, 0.99 * best, 1.01 * best, 10.0, 1e6})
      EXPECT_GT(energy(move), energy(best));
  }
}

TEST(Inflation, unit_weight_pushes_like_a_voxel) {
  // dE per unit outward motion of the whole surface is -h: the slope of (t^2)/2 at t = h.
  const Samples s = test::sphere_samples(4, 10.0);
  const std::vector<Vec3> a = area_vectors(s.layout, s.x);
  const double area = sum(sample_areas(s.layout, s.x));
  std::vector<Vec3> dx(s.x.size(), Vec3::Zero());
  EXPECT_NEAR(inflation(5000.0, 5000.0, area, 1.5, 1.0, a, dx), 0.0, 1e-12);
  double slope = 0.0;
  for (std::size_t i = 0; i < dx.size(); ++i) slope += dx[i].dot(s.normal[i]);
  EXPECT_NEAR(slope, -1.5, 0.01);
}

}  // namespace
}  // namespace pellicle
