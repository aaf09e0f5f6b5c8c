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
