// Whole fits on small phantoms with exact truth, and what must not change them.

#include <gmock/gmock.h>

#include <algorithm>
#include <functional>

#include "fit_cases.h"
#include "pellicle/base/errors.h"
#include "pellicle/base/parallel.h"

namespace pellicle {
namespace {

using test::assd;
using test::fit_ball_seed;
using test::small_phantom;

TEST(Fit, noise_free_sphere_is_found_to_three_hundredths_of_a_voxel) {
  const Phantom phantom = make_phantom(small_phantom());
  const FitResult fit = fit_ball_seed(phantom.image, Vec3(3, -2, 1), 5.0);
  EXPECT_EQ(fit.summary.status, FitStatus::ok) << fit.summary.reason;
  EXPECT_LE(assd(fit.surface, phantom.truth_surface), 0.03);
  EXPECT_NEAR(test::volume(fit.surface) / (1000.0 * phantom.exact_volume_ml), 1.0, 0.01);
  EXPECT_EQ(fit.summary.polarity, Polarity::bright);
  EXPECT_EQ(fit.summary.boundary, Boundary::step);
  EXPECT_NEAR(fit.summary.level_inside, 100.0, 2.0);
  EXPECT_NEAR(fit.summary.level_outside, 20.0, 2.0);
}

struct ShapeCase {
  const char* name;
  PhantomSettings settings;
  double tolerance;  ///< ASSD in voxels
};

ShapeCase shape_case(const char* name, double tolerance, const std::function<void(PhantomSettings&)>& change) {
  ShapeCase c{name, small_phantom(), tolerance};
  change(c.settings);
  return c;
}

std::vector<ShapeCase> shape_cases() {
  return {
      shape_case("dark", 0.05, [](auto& s) { std::swap(s.inside, s.outside); }),
      shape_case("membrane", 0.15,
                 [](auto& s) {
                   s.fill = PhantomFill::shell;
                   s.size = {56, 56, 56};
                 }),
      shape_case("anisotropic oblique ellipsoid", 0.1,
                 [](auto& s) {
                   s.shape = "ellipsoid";
                   s.size = {64, 64, 30};
                   s.spacing = Vec3(0.7, 0.7, 1.6);
                   s.direction_degrees = Vec3(25, -15, 40);
                   s.radius = {13.0, 10.0, 9.0};
                 }),
      shape_case("superquadric", 0.15,
                 [](auto& s) {
                   s.shape = "superquadric";
                   s.radius = {11.0};
                 }),
      shape_case("noisy", 0.15,
                 [](auto& s) {
                   s.noise = PhantomNoise::gaussian;
                   s.snr = 5.0;
                 }),
      shape_case("noisy with bias", 0.2,
                 [](auto& s) {
                   s.noise = PhantomNoise::gaussian;
                   s.snr = 8.0;
                   s.bias = 0.25;
                 }),
  };
}

class FitShapes : public testing::TestWithParam<std::size_t> {};

TEST_P(FitShapes, are_found_from_an_off_centre_seed) {
  const ShapeCase c = shape_cases().at(GetParam());
  const Phantom phantom = make_phantom(c.settings);
  FitOptions settings;
  if (c.settings.fill == PhantomFill::shell) settings.boundary = Boundary::ridge;  // as the preset `membrane` does
  const FitResult fit = fit_ball_seed(phantom.image, Vec3(2, -1.5, 1), 5.0, settings);
  EXPECT_EQ(fit.summary.status, FitStatus::ok) << c.name << ": " << fit.summary.reason;
  EXPECT_LE(assd(fit.surface, phantom.truth_surface), c.tolerance * phantom.image.grid.mean_spacing()) << c.name;
  EXPECT_GE(test::dice(fit.surface, phantom.truth), 0.96) << c.name;
  const TriangleMesh mesh = tessellate(fit.surface, 4);
  EXPECT_TRUE(topology_of(mesh).closed);
  EXPECT_GT(volume_of(mesh), 0.0);
  EXPECT_EQ(self_intersection_count(mesh), 0U) << c.name;
}
INSTANTIATE_TEST_SUITE_P(Phantoms, FitShapes, testing::Range<std::size_t>(0, shape_cases().size()));

/// Symmetric distance of two fits, mm, exact enough for differences of a micrometre: same parameters, same facets.
double largest_move(const Surface& a, const Surface& b) {
  const TriangleMesh p = tessellate(a, 3), q = tessellate(b, 3);
  if (p.vertices.size() != q.vertices.size()) return 1e9;
  double worst = 0.0;
  for (std::size_t i = 0; i < p.vertices.size(); ++i) worst = std::max(worst, (p.vertices[i] - q.vertices[i]).norm());
  return worst;
}

struct Twin {
  Phantom phantom = make_phantom([] {
    PhantomSettings s = small_phantom("blob");
    s.radius = {11.0};
    s.blob_amplitude = 0.2;
    s.noise = PhantomNoise::gaussian;
    s.snr = 10.0;
    return s;
  }());
  SeedSphere seed{Vec3(1, -2, 1.5), 5.0};
  FitResult fit = fit_surface({phantom.image, {Seed(seed)}}, {});
};

const Twin& twin() {
  static const Twin one;
  return one;
}

TEST(Fit, same_surface_for_other_intensity_units) {
  Image<float> other = twin().phantom.image;
  for (float& v : other.voxels) v = 7 * v + 100;
  const FitResult fit = fit_surface({other, {Seed(twin().seed)}}, {});
  EXPECT_EQ(fit.summary.status, twin().fit.summary.status);
  EXPECT_LE(largest_move(fit.surface, twin().fit.surface), 0.01);
  EXPECT_NEAR(fit.summary.evidence.score / twin().fit.summary.evidence.score, 1.0, 0.01);
}

TEST(Fit, moves_with_the_frame) {
  Image<float> other = twin().phantom.image;
  const Vec3 shift(120.5, -340.25, 77.125);
  other.grid.origin_in_world += shift;
  const FitResult fit = fit_surface({other, {Seed(SeedSphere{twin().seed.center + shift, twin().seed.radius})}}, {});
  TriangleMesh mesh = tessellate(fit.surface, 4);
  for (Vec3& x : mesh.vertices) x -= shift;
  EXPECT_LE(surface_distances(mesh, tessellate(twin().fit.surface, 4), 1.0, 4000).hd, 0.01);
}

TEST(Fit, turns_with_the_frame) {
  // The control mesh starts along the world's axes, so its samples see other voxels: equal to a fraction of the noise.
  Image<float> other = twin().phantom.image;
  const Mat3 turn = Eigen::AngleAxisd(0.8, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  other.grid.origin_in_world = turn * other.grid.origin_in_world;
  other.grid.direction = turn * other.grid.direction;
  const FitResult fit = fit_surface({other, {Seed(SeedSphere{turn * twin().seed.center, twin().seed.radius})}}, {});
  EXPECT_EQ(fit.summary.status, twin().fit.summary.status);
  TriangleMesh mesh = tessellate(fit.surface, 4);
  for (Vec3& x : mesh.vertices) x = turn.transpose() * x;
  EXPECT_LE(surface_distances(mesh, tessellate(twin().fit.surface, 4), 1.0, 4000).assd, 0.1);
}

TEST(Fit, same_surface_whatever_the_storage_order) {
  // The voxels of the same image stored with x and z swapped and y run backwards: another determinant, the same world.
  const Image<float>& image = twin().phantom.image;
  Image<float> other(image.grid);
  const int n = image.grid.size[0];
  other.grid.direction.col(0) = image.grid.direction.col(2);
  other.grid.direction.col(1) = -image.grid.direction.col(1);
  other.grid.direction.col(2) = image.grid.direction.col(0);
  other.grid.origin_in_world = image.grid.world_from_index(Vec3(0, n - 1, 0));
  for (int k = 0; k < n; ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) other.at(i, j, k) = image.at(k, n - 1 - j, i);
    }
  }
  const FitResult fit = fit_surface({other, {Seed(twin().seed)}}, {});
  EXPECT_LE(largest_move(fit.surface, twin().fit.surface), 0.01);
}

TEST(Fit, scales_with_the_voxel_size) {
  Image<float> other = twin().phantom.image;
  other.grid.spacing *= 0.01;
  other.grid.origin_in_world *= 0.01;
  const FitResult fit =
      fit_surface({other, {Seed(SeedSphere{0.01 * twin().seed.center, 0.01 * twin().seed.radius})}}, {});
  EXPECT_EQ(fit.summary.status, twin().fit.summary.status);
  TriangleMesh mesh = tessellate(fit.surface, 4);
  for (Vec3& x : mesh.vertices) x *= 100.0;
  EXPECT_LE(surface_distances(mesh, tessellate(twin().fit.surface, 4), 1.0, 4000).hd, 0.02);
}

TEST(Fit, same_bytes_on_one_thread_and_on_two) {
  Parameters one, two;
  {
    const ThreadLimit limit(1);
    one = fit_surface({twin().phantom.image, {Seed(twin().seed)}}, {}).surface.parameters;
  }
  {
    const ThreadLimit limit(2);
    two = fit_surface({twin().phantom.image, {Seed(twin().seed)}}, {}).surface.parameters;
  }
  EXPECT_EQ(one, two);
}

TEST(Fit, from_a_surface_that_is_near) {
  // The seed's own control points count as detail: ten of them stay ten, and its shape is where the fit begins.
  FitOptions settings;
  settings.detail = 1;
  const FitResult first = fit_surface({twin().phantom.image, {Seed(twin().seed)}}, settings);
  ASSERT_EQ(control_point_count(first.surface.model), 10);
  const FitResult again = fit_surface({twin().phantom.image, {Seed(first.surface)}}, settings);
  EXPECT_EQ(again.summary.status, FitStatus::ok) << again.summary.reason;
  EXPECT_EQ(control_point_count(again.surface.model), 10);
  EXPECT_LE(surface_distances(tessellate(first.surface, 4), tessellate(again.surface, 4), 1.0, 4000).assd, 0.1);
}

TEST(Fit, summary_names_stages_and_energies) {
  const FitSummary& summary = twin().fit.summary;
  ASSERT_FALSE(summary.stages.empty());
  for (const StageSummary& stage : summary.stages) {
    EXPECT_FALSE(stage.name.empty());
    EXPECT_FALSE(stage.reason().empty());
    EXPECT_GT(stage.samples, stage.control_points);
    EXPECT_EQ(stage.degrees_of_freedom, 5 * stage.control_points);
    EXPECT_THAT(stage.energy_after, testing::Contains(testing::Key("bending")));
    for (const auto& [name, value] : stage.energy_after) EXPECT_TRUE(std::isfinite(value)) << stage.name << " " << name;
  }
  EXPECT_GT(summary.iterations(), 0);
  const auto chosen = std::count_if(summary.hypotheses.begin(), summary.hypotheses.end(),
                                    [](const HypothesisSummary& h) { return h.chosen; });
  EXPECT_EQ(chosen, 1);
  for (const HypothesisSummary& h : summary.hypotheses) EXPECT_FALSE(h.name.empty());
}

TEST(SurfaceFromMask, comes_back_from_its_voxels) {
  for (const char* shape : {"ellipsoid", "bean", "blob"}) {
    PhantomSettings s = small_phantom(shape);
    s.radius = {11.0};
    s.spacing = Vec3(0.9, 1.0, 1.2);
    s.direction_degrees = Vec3(10, 20, 30);
    const Phantom phantom = make_phantom(s);
    const Surface surface = surface_from_mask(phantom.truth, {}, 3);
    EXPECT_GE(test::dice(surface, phantom.truth), 0.97) << shape;
    EXPECT_GT(test::volume(surface), 0.0);
  }
}

TEST(SplineFit, spheres_ellipsoids_and_beans) {
  FitOptions settings;
  settings.model.kind = ModelKind::spline;
  settings.detail = 1;
  for (const char* shape : {"sphere", "ellipsoid", "bean"}) {
    const Phantom phantom = make_phantom(test::small_phantom(shape));
    const FitResult result = test::fit_ball_seed(phantom.image, phantom.settings.center, 8.0, settings);
    EXPECT_EQ(result.summary.status, FitStatus::ok) << shape << ": " << result.summary.reason;
    EXPECT_LE(test::assd(result.surface, phantom.truth_surface), 0.25) << shape;
    EXPECT_EQ(model_name(result.surface.model), "spline");
  }
}

TEST(SplineFit, a_torus_from_its_mask) {
  PhantomSettings s = test::small_phantom("torus");
  s.size = {64, 64, 40};
  s.radius = {18.0, 7.0};
  const Phantom phantom = make_phantom(s);
  const Surface start = surface_from_mask(phantom.truth, {.kind = ModelKind::spline_torus}, 1);
  EXPECT_GE(test::dice(start, phantom.truth), 0.95);
  FitOptions settings;
  settings.model.kind = ModelKind::spline_torus;
  settings.detail = 1;
  const FitResult result = fit_surface({phantom.image, {Seed(start)}}, settings);
  EXPECT_EQ(result.summary.status, FitStatus::ok) << result.summary.reason;
  EXPECT_LE(test::assd(result.surface, phantom.truth_surface), 0.15);
}

TEST(SplineFit, refuses_open_surfaces) {
  const Phantom phantom = make_phantom(test::small_phantom());
  FitOptions settings;
  settings.model.kind = ModelKind::spline_cylinder;
  EXPECT_THROW(test::fit_ball_seed(phantom.image, phantom.settings.center, 8.0, settings), UsageError);
  const SurfaceModel open = start_model({.kind = ModelKind::spline_rectangle});
  const Surface seed{open, affine_image(open, Vec3::Zero(), 10 * Mat3::Identity())};
  EXPECT_THROW(fit_surface({phantom.image, {Seed(seed)}}, {}), UsageError);
}

TEST(SurfaceFromMask, takes_the_largest_part_and_refuses_nothing) {
  Phantom phantom = make_phantom(small_phantom());
  Image<std::uint8_t> mask = phantom.truth;
  for (int k = 0; k < 4; ++k) mask.at(k, 0, 0) = 1;
  const Surface surface = surface_from_mask(mask, {.solid = StartSolid::octahedron}, 2);
  EXPECT_GE(test::dice(surface, phantom.truth), 0.97);
  std::fill(mask.voxels.begin(), mask.voxels.end(), std::uint8_t{0});
  EXPECT_THROW(surface_from_mask(mask, {}, 2), BadData);
}

}  // namespace
}  // namespace pellicle
