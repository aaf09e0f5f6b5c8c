// The energy and the surface model of docs/extending.md: exact values, derivatives, and that both are what the rest of
// the program takes.

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <concepts>

#include "extending/ellipsoid_model.h"
#include "extending/floor.h"
#include "pellicle/base/random.h"
#include "pellicle/energies/energy_kinds.h"
#include "pellicle/fit/stage.h"
#include "pellicle/surface/surface.h"

namespace pellicle {
namespace {

double energy_of(const ScalarRows& rows, const std::vector<Vec3>& x) {
  double total = 0.0;
  for (std::size_t r = 0; r < rows.size(); ++r) total += 0.5 * rows.residual(r, x) * rows.residual(r, x);
  return total;
}

Vec3 random_direction(RandomEngine& random) {
  return Vec3(random.normal(), random.normal(), random.normal()).normalized();
}

/// Centre and a matrix of positive determinant, far from singular.
Parameters random_ellipsoid(RandomEngine& random) {
  Parameters p(12);
  for (std::size_t k = 0; k < 12; ++k) p[k] = (k < 3 ? 20.0 : 2.0) * random.uniform(-1.0, 1.0);
  for (const std::size_t diagonal : {3U, 7U, 11U}) p[diagonal] += 10.0;
  return p;
}

SurfaceSamples samples_at(const Parameters& p, const SampleLayout& layout, bool with_jacobian = false) {
  SurfaceSamples samples;
  EllipsoidModel().evaluate(p, layout, with_jacobian, samples);
  return samples;
}

/// The row of docs/extending.md as it stands in the table of energies.
constexpr EnergyKind kMine[] = {
#include "extending/floor_row.inc"
};

TEST(Floor, sphere_cut_in_half_has_a_sixth_of_its_squared_radius) {
  RandomEngine random(1);
  const SampleLayout layout = EllipsoidModel().layout(5);
  for (int trial = 0; trial < 5; ++trial) {
    const double radius = random.uniform(2.0, 30.0);
    const Vec3 centre(random.uniform(-99, 99), random.uniform(-99, 99), random.uniform(-99, 99));
    Parameters p{centre[0], centre[1], centre[2], radius, 0, 0, 0, radius, 0, 0, 0, radius};
    const SampledSurface sphere(layout, samples_at(p, layout));
    const Plane plane{centre, random_direction(random)};  // any plane through the centre, wherever the sphere is
    const ScalarRows rows = floor_rows(sphere, plane, 3.0);
    EXPECT_NEAR(energy_of(rows, sphere.x()) / (3.0 * radius * radius / 6.0), 1.0, 2e-3);
    const Plane beyond{centre + 1.001 * radius * plane.normal, plane.normal};
    EXPECT_EQ(floor_rows(sphere, beyond, 3.0).size(), 0U);
  }
}

TEST(Floor, derivative_by_the_unknowns_of_the_model_is_that_of_the_value) {
  RandomEngine random(2);
  const SampleLayout layout = EllipsoidModel().layout(2);
  for (int trial = 0; trial < 5; ++trial) {
    const Parameters p = random_ellipsoid(random);
    const Plane plane{Vec3(p[0], p[1], p[2]) + 2.0 * random_direction(random), random_direction(random)};
    const SampledSurface surface(layout, samples_at(p, layout));
    const std::vector<Vec3>& x = surface.x();
    // dE/dx = C^T r, then the model's adjoint: what src/solve/objective.h does for every energy.
    const ScalarRows rows = floor_rows(surface, plane, 0.7);
    ASSERT_GT(rows.size(), 20U);
    const auto energy = [&](const Parameters& at) {  // areas are those of the step's beginning
      double total = 0.0;
      for (std::size_t i = 0; i < x.size(); ++i) {
        const double beyond = plane.normal.dot(samples_at(at, layout).x[i] - plane.point);
        total += 0.7 * surface.area()[i] / surface.total_area() * std::pow(std::max(0.0, beyond), 2);
      }
      return total;
    };
    std::vector<Vec3> dE_dx(x.size(), Vec3::Zero());
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const auto k = static_cast<std::size_t>(rows.start[r]);
      dE_dx[static_cast<std::size_t>(rows.sample[k])] += rows.residual(r, x) * rows.coefficient[k];
    }
    std::vector<double> gradient(12, 0.0);
    EllipsoidModel().pull_back(p, layout, dE_dx, gradient);
    double largest = 0.0;
    for (const double g : gradient) largest = std::max(largest, std::abs(g));
    for (std::size_t k = 0; k < 12; ++k) {
      Parameters before = p, after = p;
      before[k] -= 1e-4;
      after[k] += 1e-4;
      const double slope = (energy(after) - energy(before)) / 2e-4;
      EXPECT_NEAR(gradient[k], slope, 1e-4 * largest) << "unknown " << k;
    }
  }
}

TEST(Floor, a_row_of_ones_own_takes_part_in_a_stage) {
  const EnergyKind& floor = kMine[0];
  const Image<float> image(ImageGrid{.size = {40, 40, 40},
                                     .spacing = Vec3::Ones(),
                                     .origin_in_world = Vec3::Constant(-19.5),
                                     .direction = Mat3::Identity()});
  const SurfaceModel model = start_model({});
  const ExpertPoints no_points;
  GeometryCache geometry;
  const Observer nobody;
  const Stage stage{.name = "dish",
                    .detail = 1,
                    .energies = {{floor, 1.0}, {energy::bending, 1e-4}, {energy::spacing, 0.05}},
                    .smoothing = 0.0,
                    .max_steps = 30,
                    .tolerance = 1e-4};
  EXPECT_NO_THROW(stage.validate());
  Candidate ball{.surface = {model, on_ellipsoid(model, Vec3(0, 0, 5), 9.0 * Mat3::Identity())}};
  const auto lowest = [&] {
    double z = 1e9;
    for (const Vec3& v : tessellate(ball.surface, 3).vertices) z = std::min(z, v.z());
    return z;
  };
  EXPECT_LT(lowest(), -3.0);
  const StageOutcome outcome = run_stage({image, no_points, geometry, nobody}, {stage}, ball);
  EXPECT_EQ(ball.status, FitStatus::ok) << ball.reason;
  EXPECT_GT(lowest(), -0.3);
  ASSERT_TRUE(outcome.summary.energy_after.contains("floor"));
  EXPECT_LT(outcome.summary.energy_after.at("floor"), 0.01 * outcome.summary.energy_before.at("floor"));
}

TEST(Ellipsoid, samples_and_normals_are_those_of_the_ellipsoid) {
  RandomEngine random(3);
  const SampleLayout layout = EllipsoidModel().layout(3);
  const Parameters p = random_ellipsoid(random);
  const Vec3 centre(p.data());
  const Mat3 a = Eigen::Map<const Mat3>(p.data() + 3);  // columns one after another
  const SurfaceSamples samples = samples_at(p, layout);
  ASSERT_EQ(samples.x.size(), 642U);
  for (std::size_t i = 0; i < samples.x.size(); ++i) {
    const Vec3 on_sphere = a.inverse() * (samples.x[i] - centre);
    EXPECT_NEAR(on_sphere.norm(), 1.0, 1e-12);
    const Vec3 normal = (a.inverse().transpose() * on_sphere).normalized();  // gradient of |A^-1 (x - c)|^2
    EXPECT_LT((samples.normal[i] - normal).norm(), 1e-12);
  }
  // The facets lie inside, and miss the volume 4/3 pi det A by their size squared.
  const double volume = 4.0 / 3.0 * std::acos(-1.0) * a.determinant();
  const double coarse = 1.0 - facet_volume(layout, samples.x) / volume;
  const SampleLayout finer = EllipsoidModel().layout(4);
  const double fine = 1.0 - facet_volume(finer, samples_at(p, finer).x) / volume;
  EXPECT_GT(fine, 0.0);
  EXPECT_NEAR(fine / coarse, 0.25, 0.01);
}

TEST(Ellipsoid, jacobian_is_that_of_the_samples) {
  RandomEngine random(4);
  const SampleLayout layout = EllipsoidModel().layout(1);
  const Parameters p = random_ellipsoid(random);
  const SurfaceSamples samples = samples_at(p, layout, true);
  ASSERT_EQ(samples.jacobian.size(), 36 * samples.x.size());
  for (std::size_t k = 0; k < 12; ++k) {
    Parameters before = p, after = p;
    before[k] -= 1e-3;
    after[k] += 1e-3;
    const std::vector<Vec3> low = samples_at(before, layout).x, high = samples_at(after, layout).x;
    for (std::size_t i = 0; i < samples.x.size(); ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto row = static_cast<Eigen::Index>(axis);
        EXPECT_NEAR(samples.jacobian[36 * i + 12 * axis + k], (high[i][row] - low[i][row]) / 2e-3, 1e-9);
      }
    }
  }
}

/// What src/surface/surface.h asks of every model in its std::variant.
template <class Model>
concept SurfaceModelParts = requires(const Model& m, const Parameters& p, const SampleLayout& layout,
                                     SurfaceSamples& samples, const std::vector<Vec3>& dE_dx,
                                     std::vector<double>& gradient) {
  { m.blocks() } -> std::same_as<std::vector<BlockKind>>;
  { m.reference() } -> std::convertible_to<Parameters>;
  { m.layout(2) } -> std::same_as<SampleLayout>;
  m.evaluate(p, layout, true, samples);
  m.pull_back(p, layout, dE_dx, gradient);
  { m.refine(p) } -> std::same_as<std::pair<Model, Parameters>>;
  { m.base_facets() } -> std::same_as<int>;
  { m.degrees_of_freedom() } -> std::same_as<int>;
  { m.refinements() } -> std::same_as<int>;
  { m.is_closed() } -> std::same_as<bool>;
  { m.control_mesh(p) } -> std::same_as<TriangleMesh>;
  { m.name() } -> std::same_as<std::string>;
};
static_assert(SurfaceModelParts<NormalModel> && SurfaceModelParts<SplineModel> &&
              SurfaceModelParts<CatmullClarkModel> && SurfaceModelParts<SlimeModel>);
static_assert(SurfaceModelParts<EllipsoidModel>);

TEST(Ellipsoid, control_mesh_is_closed_and_outward) {
  const TriangleMesh mesh = EllipsoidModel().control_mesh(EllipsoidModel().reference());
  double volume = 0.0;
  for (const auto& t : mesh.triangles) {
    const auto corner = [&](std::size_t c) { return mesh.vertices[static_cast<std::size_t>(t[c])]; };
    volume += corner(0).dot(corner(1).cross(corner(2))) / 6.0;
  }
  EXPECT_NEAR(volume, 4.0 / 3.0, 1e-12);  // of the regular octahedron with corners on the unit sphere
}

}  // namespace
}  // namespace pellicle
