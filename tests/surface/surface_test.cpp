#include "pellicle/surface/surface.h"

#include <gtest/gtest.h>

#include "shapes.h"

namespace pellicle {
namespace {

Surface sphere(double radius) {
  NormalModel model = NormalModel::start(StartSolid::octahedron, SubdivisionRule::smooth);
  Parameters parameters = affine_image(model, Vec3(1, 2, 3), radius * Mat3::Identity());
  return {std::move(model), std::move(parameters)};
}

TEST(Surface, ForwardsToTheModel) {
  const Surface surface = sphere(2);
  EXPECT_EQ(model_name(surface.model), "normal");
  EXPECT_EQ(control_point_count(surface.model), 6);
  EXPECT_EQ(degrees_of_freedom(surface.model), 30);
  EXPECT_EQ(blocks_of(surface.model).size(), 12U);
  EXPECT_EQ(control_point_count(refine(surface).model), 18);
  const SampleLayout layout = layout_of(surface.model, 2);
  std::vector<double> gradient(surface.parameters.size(), 0.0);
  pull_back(surface.model, surface.parameters, layout, std::vector<Vec3>(layout.patch_of.size(), Vec3(1, 0, 0)),
            gradient);
  double sum = 0;  // moving all points along x moves all samples along x
  for (int v = 0; v < 6; ++v) sum += gradient[6 * std::size_t(v)];
  EXPECT_NEAR(sum, layout.sample_count(), 1e-10);
}

std::vector<ModelChoice> every_model() {
  return {{.kind = ModelKind::normal},
          {.kind = ModelKind::spline},
          {.kind = ModelKind::spline_torus},
          {.kind = ModelKind::spline_cylinder},
          {.kind = ModelKind::spline_rectangle},
          {.kind = ModelKind::catmull_clark},
          {.kind = ModelKind::slime}};
}

Mat3 skewed_map() {
  Mat3 A;
  A << 2, 0.3, -0.4, 0.1, 1.2, 0.5, -0.2, 0.3, 0.7;
  return A;
}

TEST(EveryModel, MovesAsOneBody) {
  for (const ModelChoice& choice : every_model()) {
    SurfaceModel model = start_model(choice);
    Parameters parameters = affine_image(model, Vec3(1, 2, 3), skewed_map());
    const SampleLayout layout = layout_of(model, 2);
    std::vector<double> gradient(parameters.size(), 0.0);
    pull_back(model, parameters, layout, std::vector<Vec3>(layout.patch_of.size(), Vec3(1, 0, 0)), gradient);
    double sum = 0;  // moving all points along x moves all samples along x
    const std::vector<BlockKind> blocks = blocks_of(model);
    for (std::size_t b = 0; b < blocks.size(); ++b) sum += blocks[b] == BlockKind::point ? gradient[3 * b] : 0.0;
    EXPECT_NEAR(sum, layout.sample_count(), 1e-9) << model_name(model);
    EXPECT_EQ(3 * blocks.size(), parameters.size());
  }
}

TEST(EveryModel, AffineImageIsTheImageOfTheReferenceShape) {
  for (const ModelChoice& choice : every_model()) {
    const SurfaceModel model = start_model(choice);
    for (const int level : {0, 2}) {
      const SampleLayout layout = layout_of(model, level);
      SurfaceSamples samples;
      evaluate(model, affine_image(model, Vec3(1, 2, 3), Mat3::Identity()), layout, false, samples);
      ASSERT_EQ(layout.reference.size(), samples.x.size());
      // these two come near the sphere that they are measured against
      const bool near = choice.kind == ModelKind::catmull_clark || choice.kind == ModelKind::slime;
      const double tolerance = near ? 0.06 : 1e-13;
      for (int i = 0; i < layout.sample_count(); ++i) {
        EXPECT_LE((samples.x[i] - Vec3(1, 2, 3) - layout.reference[i]).norm(), tolerance) << model_name(model);
      }
    }
    const TriangleMesh mesh = tessellate({model, affine_image(model, Vec3(1, 2, 3), 2 * Mat3::Identity())}, 3);
    EXPECT_EQ(mesh.triangles.size(), std::size_t(base_facets(model)) * 64);
    for (const auto& [a, b, c] : mesh.triangles) {
      const Vec3 facet = (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
      EXPECT_GT(facet.dot(mesh.normals[a]), 0.0) << model_name(model);
    }
  }
}

TEST(EveryModel, AtRestItsShapeIsItsReference) {
  for (const ModelChoice& choice : every_model()) {
    const SurfaceModel model = start_model(choice);
    const Surface surface{model, affine_image(model, Vec3(1, 2, 3), skewed_map())};
    const Surface rested = at_rest(surface);
    EXPECT_EQ(rested.parameters, surface.parameters) << model_name(model);
    EXPECT_EQ(is_closed(rested.model), is_closed(model)) << model_name(model);
    const bool keeps = std::holds_alternative<SplineModel>(model);
    const Parameters expected = keeps ? affine_image(model, Vec3::Zero(), Mat3::Identity()) : surface.parameters;
    const Parameters reference = affine_image(rested.model, Vec3::Zero(), Mat3::Identity());
    ASSERT_EQ(reference.size(), expected.size());
    for (std::size_t k = 0; k < expected.size(); ++k) EXPECT_NEAR(reference[k], expected[k], 1e-12);
    const SampleLayout before = layout_of(model, 2), after = layout_of(rested.model, 2);
    SurfaceSamples was, is;
    evaluate(model, surface.parameters, before, false, was);
    evaluate(rested.model, rested.parameters, after, false, is);
    EXPECT_EQ(was.x, is.x) << model_name(model);
  }
}

TEST(EveryModel, LevelsShareTheirSamples) {
  for (const ModelChoice& choice : every_model()) {
    const SurfaceModel model = start_model(choice);
    const SampleLayout coarse = layout_of(model, 1), fine = layout_of(model, 2);
    EXPECT_LE(shapes::farthest(coarse.reference, fine.reference), 1e-12) << model_name(model);
  }
}

TEST(EveryModel, CountsItsRefinements) {
  for (const ModelChoice& choice : every_model()) {
    Surface surface{start_model(choice), {}};
    surface.parameters = affine_image(surface.model, Vec3(1, 2, 3), skewed_map());
    for (int times = 0; times <= 3; ++times) {
      EXPECT_EQ(refinements_of(surface.model), times) << model_name(surface.model);
      const int before = control_point_count(surface.model);
      surface = refine(surface);
      EXPECT_GT(control_point_count(surface.model), 1.5 * before) << model_name(surface.model);
    }
  }
  for (const StartSolid solid : shapes::kSolids) {
    SurfaceModel model = NormalModel::start(solid, SubdivisionRule::smooth);
    EXPECT_EQ(refinements_of(model), 0);
  }
}

TEST(EveryModel, KnowsWhetherItIsClosed) {
  std::vector<std::string> open;
  for (const ModelChoice& choice : every_model()) {
    const SurfaceModel model = start_model(choice);
    if (!is_closed(model)) open.push_back(model_name(model));
  }
  EXPECT_EQ(open, (std::vector<std::string>{"spline-cylinder", "spline-rectangle"}));
}

TEST(OnEllipsoid, SphereModelsAreThatEllipsoid) {
  for (const ModelKind kind : {ModelKind::normal, ModelKind::spline}) {
    const SurfaceModel model = start_model({.kind = kind, .solid = StartSolid::icosahedron});
    const Vec3 centre(1, 2, 3);
    const Surface surface{model, on_ellipsoid(model, centre, skewed_map())};
    // normal subdivision follows spheres, not affine maps: its control points lie there, its samples nearly
    const std::vector<Vec3> on =
        (kind == ModelKind::normal ? control_mesh_of(surface) : tessellate(surface, 2)).vertices;
    for (const Vec3& x : on) EXPECT_NEAR((skewed_map().inverse() * (x - centre)).norm(), 1.0, 1e-12);
  }
}

TEST(OnEllipsoid, SplinePolesLieOnTheLongestAxis) {
  const SurfaceModel model = start_model({.kind = ModelKind::spline});
  RandomEngine random(5);
  for (int trial = 0; trial < 20; ++trial) {
    const Mat3 turn = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitX(), shapes::random_unit(random)).toRotationMatrix();
    const Mat3 other =
        Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), shapes::random_unit(random)).toRotationMatrix();
    const Mat3 shape = turn * Vec3(5, 2, 1).asDiagonal() * other;
    const Parameters p = on_ellipsoid(model, Vec3(1, 2, 3), shape);
    const Vec3 axis = Vec3(&p[0]) - Vec3(1, 2, 3);
    EXPECT_NEAR(axis.norm(), 5.0, 1e-12);
    EXPECT_NEAR(std::abs(axis.dot(turn.col(0))), 5.0, 1e-12);
    EXPECT_LE((Vec3(&p[3]) - Vec3(1, 2, 3) + axis).norm(), 1e-12);
  }
  const Parameters ball = on_ellipsoid(model, Vec3::Zero(), 3.0 * Mat3::Identity());
  EXPECT_LE((Vec3(&ball[0]) - Vec3(0, 0, 3)).norm(), 1e-14) << "a ball has no longest axis";
}

TEST(OnEllipsoid, TorusHasTheSameMoments) {
  const SurfaceModel model = start_model({.kind = ModelKind::spline_torus});
  const Mat3 shape = skewed_map();
  const TriangleMesh mesh = tessellate({model, on_ellipsoid(model, Vec3(1, 2, 3), shape)}, 5);
  double volume = 0;
  Mat3 second = Mat3::Zero();
  for (const auto& [a, b, c] : mesh.triangles) {  // tetrahedra from the centre
    Mat3 corners;
    corners << mesh.vertices[a] - Vec3(1, 2, 3), mesh.vertices[b] - Vec3(1, 2, 3), mesh.vertices[c] - Vec3(1, 2, 3);
    const double part = corners.determinant() / 6;
    const Vec3 sum = corners.rowwise().sum();
    volume += part;
    second += part / 20 * (corners * corners.transpose() + sum * sum.transpose());
  }
  EXPECT_GT(volume, 0);
  EXPECT_LE((second / volume - shape * shape.transpose() / 5).norm(), 2e-3 * (shape * shape.transpose()).norm());
}

TEST(Surface, TessellationIsClosedOutwardAndHasNormals) {
  const TriangleMesh mesh = tessellate(sphere(2), 3);
  EXPECT_EQ(mesh.vertices.size(), 2 + 4U * 64);
  EXPECT_EQ(mesh.normals.size(), mesh.vertices.size());
  EXPECT_EQ(mesh.triangles.size(), 8U * 64);
  EXPECT_GT(shapes::flat_volume(mesh), 0.97 * 4.0 / 3 * 3.14159 * 8);
}

TEST(Surface, LevelMeetsTheEdgeLength) {
  for (const double edge : {5.0, 1.0, 0.3, 0.05}) {
    const Surface surface = sphere(2);
    const int level = tessellation_level(surface, edge);
    const auto rms = [&](int at) {
      const TriangleMesh mesh = tessellate(surface, at);
      double sum = 0;
      for (const auto& [a, b, c] : mesh.triangles) sum += (mesh.vertices[a] - mesh.vertices[b]).squaredNorm();
      return std::sqrt(sum / static_cast<double>(mesh.triangles.size()));
    };
    EXPECT_LE(rms(level), 1.15 * edge);
    if (level == 0) continue;
    EXPECT_GE(rms(level - 1), 0.85 * edge) << "one level less would not do";
  }
  EXPECT_EQ(tessellation_level(sphere(2), 1e-9), 7);
  EXPECT_EQ(tessellation_level(sphere(2), 1e9), 0);
  EXPECT_EQ(tessellation_level(sphere(0), 1), 0);
}

TEST(Surface, ControlMeshIsTheParameters) {
  const Surface surface = sphere(2);
  const TriangleMesh mesh = control_mesh_of(surface);
  ASSERT_EQ(mesh.vertices.size(), 6U);
  EXPECT_EQ(mesh.triangles.size(), 8U);
  for (int v = 0; v < 6; ++v) {
    EXPECT_EQ(mesh.vertices[v], shapes::point(surface.parameters, v));
    EXPECT_EQ(mesh.normals[v], shapes::normal(surface.parameters, v));
  }
}

}  // namespace
}  // namespace pellicle
