// Fits to geometry: exact shapes, invariance, detail, noise, outliers, holes.
#include "pellicle/fit/geometry/point_fit.h"

#include <gmock/gmock.h>

#include "pellicle/base/random.h"
#include "pellicle/mesh/distance.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/mesh/points/rim.h"
#include "pellicle/raster/closed_solid.h"
#include "pellicle/raster/cup.h"
#include "pellicle/seed/open_seed.h"
#include "pellicle/seed/seed_surface.h"
#include "pellicle/seed/voxel_seed.h"

#include "../mesh/test_meshes.h"

namespace pellicle {
namespace {

GeometryData cloud_of(std::vector<Vec3> points) {
  GeometryData data;
  data.points = std::move(points);
  data.diameter = diameter_of(data.points);
  return data;
}

SurfaceModel model_of(ModelKind kind, int detail) {
  ModelChoice choice;
  choice.kind = kind;
  Surface surface{start_model(choice), {}};
  surface.parameters = affine_image(surface.model, Vec3::Zero(), Mat3::Identity());
  for (int k = 0; k < detail; ++k) surface = refine(surface);
  return surface.model;
}

// Few steps are enough to see what these tests look at; clouds begin with nine that trust far points.
PointFitSettings few_steps(const GeometryData& data) {
  PointFitSettings settings;
  settings.max_steps = data.robust ? 12 : 6;
  return settings;
}

PointFit fitted(ModelKind kind, int detail, const GeometryData& data, const TriangleMesh& solid,
                bool hold_out = false) {
  PointFit fit =
      fit_to_map(model_of(kind, detail), data, {map_to_sphere(solid), Mat3::Identity()}, few_steps(data), hold_out);
  measure_fit(data, fit);
  return fit;
}

TriangleMesh ellipsoid(int level) {
  return test::moved(test::sphere(level, 1.0), [](const Vec3& n) -> Vec3 {
    return Vec3(40, -10, 5) +
           Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()) * Vec3(10 * n.x(), 15 * n.y(), 20 * n.z());
  });
}

/// Bent, with a waist: nothing that a model of few points has exactly.
TriangleMesh bean(int level) {
  return test::moved(test::sphere(level, 1.0), [](const Vec3& n) -> Vec3 {
    const double waist = 1.0 - 0.45 * std::exp(-6.0 * n.z() * n.z());
    return {10.0 * waist * n.x() + 6.0 * n.z() * n.z(), 10.0 * waist * n.y(), 20.0 * n.z()};
  });
}

TEST(DiameterOf, IsTheLargestDistance) {
  EXPECT_NEAR(diameter_of(test::sphere(3, 5.0, Vec3(100, 0, 0)).vertices), 10.0, 0.05);
  EXPECT_EQ(diameter_of({Vec3(1, 2, 3)}), 0.0);
}

class Kinds : public testing::TestWithParam<ModelKind> {};

TEST_P(Kinds, EllipsoidsAreMetToTheirFacets) {
  const TriangleMesh mesh = ellipsoid(3);
  const PointFit fit = fitted(GetParam(), 1, data_of(mesh, 1000), mesh);
  // The facets of the data themselves miss the ellipsoid by 0.4 % of the diameter.
  EXPECT_TRUE(fit.summary.to_surface.rms <= 0.003 * 40.0) << fit.summary.to_surface.rms;
  EXPECT_EQ(fit.summary.self_intersections, 0U);
}

TEST_P(Kinds, MoreDetailLeavesLess) {
  const TriangleMesh mesh = bean(3);
  const GeometryData data = data_of(mesh, 1000);
  double before = 1e300;
  for (const int detail : {0, 1}) {
    const PointFit fit = fitted(GetParam(), detail, data, mesh);
    EXPECT_TRUE(fit.summary.to_surface.rms < 0.8 * before) << detail;
    EXPECT_TRUE(fit.summary.to_data.rms < 3.0 * fit.summary.to_surface.rms + 1e-3 * data.diameter) << detail;
    before = fit.summary.to_surface.rms;
  }
  EXPECT_TRUE(before <= 0.02 * data.diameter) << before;
}

TEST_P(Kinds, KnowNoPlaceNoSizeAndNoTurn) {
  // Steps of the normal model are damped, millimetres and unit normals alike: only where they end is free of the size.
  const auto settled = [](const TriangleMesh& mesh) {
    const GeometryData data = data_of(mesh, 500);
    const PointFitSettings settings = GetParam() == ModelKind::normal ? PointFitSettings{} : few_steps(data);
    PointFit fit = fit_to_map(model_of(GetParam(), 1), data, {map_to_sphere(mesh), Mat3::Identity()}, settings, false);
    measure_fit(data, fit);
    return fit.summary.to_surface.rms;
  };
  const TriangleMesh mesh = bean(2);
  const Mat3 turn = Eigen::AngleAxisd(1.1, Vec3(1, -1, 2).normalized()).toRotationMatrix();
  const double size = 0.013;
  const TriangleMesh moved =
      test::moved(mesh, [&](const Vec3& x) -> Vec3 { return Vec3(3, 900, -70) + size * (turn * x); });
  EXPECT_NEAR(settled(moved) / (size * settled(mesh)), 1.0, 0.05);
}

TEST_P(Kinds, NoiseOutliersAndAHoleMoveItLittle) {
  const TriangleMesh mesh = ellipsoid(3);
  std::vector<Vec3> points = sample_surface(mesh, 1200);
  std::erase_if(points, [](const Vec3& x) { return x.z() > 17.0; });
  ASSERT_LT(points.size(), 1150U);
  RandomEngine random(9);
  for (Vec3& x : points) x += 0.2 * Vec3(random.normal(), random.normal(), random.normal());
  for (int i = 0; i < 60; ++i)
    points.emplace_back(40 + random.uniform(-30, 30), random.uniform(-40, 20), random.uniform(-25, 35));
  GeometryData data = cloud_of(points);
  data.diameter = 40.0;
  const PointFit fit = fitted(GetParam(), 1, data, mesh);
  const SurfaceDistances d = surface_distances(measuring_mesh(fit.surface), mesh, 0.2, 2000);
  EXPECT_TRUE(d.assd <= 0.2) << d.assd;      // about the noise
  EXPECT_TRUE(d.hd <= 0.05 * 40.0) << d.hd;  // in the hole
}

INSTANTIATE_TEST_SUITE_P(Models, Kinds, testing::Values(ModelKind::normal, ModelKind::spline));

TEST(FitToMap, LeavesPointsOutWhenAskedAndIsTheSameTwice) {
  const TriangleMesh mesh = bean(2);
  const GeometryData data = data_of(mesh, 500);
  const PointFit all = fitted(ModelKind::spline, 0, data, mesh), again = fitted(ModelKind::spline, 0, data, mesh),
                 fewer = fitted(ModelKind::spline, 0, data, mesh, true);
  EXPECT_EQ(all.summary.held_out_rms, -1.0);
  EXPECT_EQ(all.surface.parameters, again.surface.parameters);
  EXPECT_TRUE(fewer.summary.held_out_rms > 0.0);
  EXPECT_NE(all.surface.parameters, fewer.surface.parameters);
}

TEST(ChooseAxis, ReturnsARotation) {
  const Correspondence c = choose_axis(map_to_sphere(bean(2)), model_of(ModelKind::spline, 1));
  EXPECT_NEAR(c.map_from_reference.determinant(), 1.0, 1e-12);
  EXPECT_LE((c.map_from_reference * c.map_from_reference.transpose() - Mat3::Identity()).norm(), 1e-12);
}

TEST(FitFrom, AnyGenusFromVoxels) {
  const TriangleMesh mesh = test::torus(30, 15, 15.0, 5.0);
  ModelChoice choice;
  choice.kind = ModelKind::catmull_clark;
  const GeometryData data = data_of(mesh, 1000);
  const VoxelSeed voxels = voxel_seed_of_mask(solid_of_points(data.points, 0.5).as_given, 4.5);
  ASSERT_EQ(voxels.genus, 1);
  PointFit fit = fit_from(*seed_surface(voxels.mesh, choice), data, few_steps(data), false);
  measure_fit(data, fit);
  EXPECT_TRUE(fit.summary.to_surface.rms <= 0.003 * data.diameter) << fit.summary.to_surface.rms;
  EXPECT_EQ(topology_of(measuring_mesh(fit.surface)).genus, 1);
}

TEST(FitFrom, PullsASurfaceThatIsNear) {
  const TriangleMesh mesh = ellipsoid(3);
  const SurfaceModel model = model_of(ModelKind::spline, 1);
  const Surface start{model, affine_image(model, Vec3(40, -10, 5), 14.0 * Mat3::Identity())};
  const GeometryData data = data_of(mesh, 1000);
  PointFit fit = fit_from(start, data, few_steps(data), false);
  measure_fit(data, fit);
  EXPECT_TRUE(fit.summary.to_surface.rms <= 0.003 * 40.0) << fit.summary.to_surface.rms;
}

TEST(FitFrom, TheLargestResidualIsTradedForTheRest) {
  // A ball with a thorn that few control points cannot follow.
  const TriangleMesh mesh = test::moved(test::sphere(4, 1.0), [](const Vec3& n) -> Vec3 {
    return (10.0 + 4.0 * std::exp(-20.0 * (1.0 - n.dot(Vec3(1, 2, 3).normalized())))) * n;
  });
  const GeometryData data = data_of(mesh, 2000);
  const SurfaceModel model = model_of(ModelKind::catmull_clark, 0);
  const Surface start{model, affine_image(model, Vec3::Zero(), 12.0 * Mat3::Identity())};
  PointFitSettings settings = few_steps(data);
  PointFit least_squares = fit_from(start, data, settings, false);
  measure_fit(data, least_squares);
  const Residual before = least_squares.summary.to_surface;
  settings.largest_residual = 0.6 * before.max;
  PointFit bounded = fit_from(start, data, settings, false);
  measure_fit(data, bounded);
  const Residual after = bounded.summary.to_surface;
  EXPECT_TRUE(after.max < 0.8 * before.max) << after.max << " of " << before.max;
  EXPECT_TRUE(after.rms > before.rms && after.rms < 2.0 * before.rms) << after.rms << " of " << before.rms;
  // Data with outliers are left alone.
  GeometryData cloud = data;
  cloud.robust = true;
  settings.largest_residual.reset();
  const PointFit robust = fit_from(start, cloud, settings, false);
  settings.largest_residual = 0.6 * before.max;
  EXPECT_EQ(fit_from(start, cloud, settings, false).surface.parameters, robust.surface.parameters);
}

// 2000 points of a ball with noise: `lifted` of them, around a pole or spread evenly, lie a tenth of the diameter out.
double astray_share_with(int lifted, bool together) {
  RandomEngine random(7);
  std::vector<Vec3> points = sample_surface(test::sphere(4, 10.0), 2000);
  std::sort(points.begin(), points.end(), [](const Vec3& a, const Vec3& b) { return a.z() > b.z(); });
  for (std::size_t k = 0; k < points.size(); ++k) {
    const std::size_t every = points.size() / static_cast<std::size_t>(lifted);
    const bool out = together ? k < static_cast<std::size_t>(lifted) : k % every == 0;
    points[k] *= (out ? 1.2 : 1.0) + 0.002 * random.normal();
  }
  const SurfaceModel model = model_of(ModelKind::spline, 1);
  PointFit fit{{model, affine_image(model, Vec3::Zero(), 10.0 * Mat3::Identity())}, {}};
  measure_fit(cloud_of(points), fit);
  return fit.summary.astray_share;
}

TEST(MeasureFit, ManyPointsTogetherBesideTheSurfaceAreNoOutliers) {
  EXPECT_NEAR(astray_share_with(60, true), 0.03, 0.005);
  EXPECT_EQ(astray_share_with(60, false), 0.0);
}

PointFit open_fit(const std::vector<Vec3>& points, GeometryData& data) {
  data = cloud_of(points);
  const PointTree tree(points);
  const OpenPoints open{tree, plane_normals(tree)};
  const Image<std::uint8_t> body = filled_cup(points, point_spacing(tree));
  data.rim = rims_of(body, open);
  const VoxelSeed voxels = voxel_seed_of_mask(body, 4.0);
  auto [model, parameters] = open_seed(voxels.mesh, open, data.rim, voxels.spacing_mm);
  PointFit fit = fit_from({std::move(model), std::move(parameters)}, data, few_steps(data), false);
  measure_fit(data, fit);
  EXPECT_EQ(fit.summary.border_loops, 1);
  EXPECT_EQ(fit.summary.genus, 0);
  EXPECT_EQ(fit.summary.self_intersections, 0U);
  return fit;
}

Vec3 on_blob(const Vec3& n) {
  return 10.0 * (1.0 + 0.2 * n.x() * n.y() + 0.15 * n.x() * n.x()) * n;
}

TEST(FitFrom, AnOpenSurfaceEndsAtTheRim) {
  // Half of a blob, cut by the plane z = 0; points are 0.6 mm apart.
  std::vector<Vec3> points;
  for (int k = 0; k < 3000; ++k) {
    const double z = 1.0 - 2.0 * (k + 0.5) / 3000, r = std::sqrt(1.0 - z * z), angle = 2.399963229728653 * k;
    if (z > 0.0) points.push_back(on_blob({r * std::cos(angle), r * std::sin(angle), z}));
  }
  GeometryData data;
  const PointFit fit = open_fit(points, data);
  EXPECT_LE(fit.summary.to_surface.rms, 0.003 * data.diameter);
  double lowest = 0.0;
  for (const Vec3& x : measuring_mesh(fit.surface).vertices) lowest = std::min(lowest, x.z());
  EXPECT_GE(lowest, -0.3);                     // it does not go on
  EXPECT_LE(fit.summary.to_surface.max, 0.6);  // nor ends before
}

TEST(FitFrom, TheBorderOfRandomNoisyPointsIsSmooth) {
  RandomEngine random(3);
  std::vector<Vec3> points;
  while (points.size() < 1500) {
    const double z = random.uniform(), angle = random.uniform(0.0, 6.283185307), r = std::sqrt(1.0 - z * z);
    const Vec3 noise(random.normal(), random.normal(), random.normal());
    points.push_back(on_blob({r * std::cos(angle), r * std::sin(angle), z}) + 0.05 * noise);
  }
  GeometryData data;
  const TriangleMesh mesh = measuring_mesh(open_fit(points, data).surface);
  const auto loops = border_loops(mesh.triangles);
  ASSERT_EQ(loops.size(), 1U);
  std::vector<Vec3> border;
  for (const int v : loops[0]) border.push_back(mesh.vertices[static_cast<std::size_t>(v)]);
  const std::vector<Vec3> corners = evenly_along(border, 100);
  double turning = 0.0;
  for (std::size_t k = 0; k < 100; ++k) {
    EXPECT_NEAR(corners[k].z(), 0.0, 0.7);  // as far as points lie apart
    const Vec3 before = corners[(k + 1) % 100] - corners[k], after = corners[(k + 2) % 100] - corners[(k + 1) % 100];
    turning += std::atan2(before.cross(after).norm(), before.dot(after));
  }
  EXPECT_LE(turning, 1.1 * 6.283185307);  // a plane convex curve turns once; waves and curls turn more
}

}  // namespace
}  // namespace pellicle
