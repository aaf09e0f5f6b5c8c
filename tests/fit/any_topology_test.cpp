// Models over quad control meshes in whole fits, and masks with handles as seeds.

#include <gtest/gtest.h>

#include <algorithm>

#include "fit_cases.h"
#include "pellicle/base/random.h"
#include "pellicle/fit/stage.h"

namespace pellicle {
namespace {

using namespace test;

class QuadModelFit : public testing::TestWithParam<ModelKind> {};
INSTANTIATE_TEST_SUITE_P(All, QuadModelFit, testing::Values(ModelKind::catmull_clark, ModelKind::slime));

TEST_P(QuadModelFit, FindsAnEllipsoidFromABall) {
  PhantomSettings s = small_phantom("ellipsoid");
  s.radius = {14, 11, 9};
  const Phantom phantom = make_phantom(s);
  FitOptions settings;
  settings.model.kind = GetParam();
  const FitResult result = fit_ball_seed(phantom.image, Vec3(1, -1, 1), 5.0, settings);
  EXPECT_EQ(result.summary.status, FitStatus::ok) << result.summary.reason;
  EXPECT_GE(dice(result.surface, phantom.truth), 0.96);
  EXPECT_LE(assd(result.surface, phantom.truth_surface), 0.3);
}

class HandledMask : public testing::TestWithParam<ModelKind> {};
INSTANTIATE_TEST_SUITE_P(All, HandledMask,
                         testing::Values(ModelKind::normal, ModelKind::catmull_clark, ModelKind::slime));

TEST_P(HandledMask, StartsFromItsVoxelsAndKeepsTheHandle) {
  PhantomSettings s = small_phantom("torus");
  s.radius = {16.0};
  s.size = {56, 56, 40};
  const Phantom phantom = make_phantom(s);
  ModelChoice choice;
  choice.kind = GetParam();
  const Surface start = surface_from_mask(phantom.truth, choice, 2);
  const TriangleMesh mesh = tessellate(start, 3);
  const MeshTopology t = topology_of(mesh);
  EXPECT_TRUE(t.closed && t.manifold && t.oriented) << t.first_fault;
  EXPECT_EQ(t.genus, 1);
  EXPECT_GE(dice(start, phantom.truth), 0.95);
  EXPECT_LE(assd(start, phantom.truth_surface), 0.4);
}

// A torus whose ring leaves the volume above and below: what is cut off must not go on.
TEST_P(HandledMask, EndsWhereTheVolumeCutsIt) {
  ImageGrid grid;
  grid.size = {56, 56, 10};  // the torus's own plane is at 5
  Image<std::uint8_t> cut(grid);
  for (int k = 0; k < grid.size[2]; ++k) {
    for (int j = 0; j < grid.size[1]; ++j) {
      for (int i = 0; i < grid.size[0]; ++i) {
        const double from_circle = std::hypot(i - 27.5, j - 27.5) - 17.0;
        cut.at(i, j, k) = std::hypot(from_circle, k - 5.0) < 7.0 ? 1 : 0;
      }
    }
  }
  ModelChoice choice;
  choice.kind = GetParam();
  const Surface start = surface_from_mask(cut, choice, 2);
  EXPECT_EQ(topology_of(tessellate(start, 3)).genus, 1);
  EXPECT_GE(dice(start, cut), 0.93);
  double highest = -1e300;
  for (const Vec3& x : tessellate(start, 3).vertices) highest = std::max(highest, grid.index_from_world(x)[2]);
  EXPECT_LE(highest, grid.size[2] + 1.0);
}

// Noise alone draws a surface nowhere in particular: another tool's mask is handed back, and not as ok.
TEST(MaskAsSeed, IsKeptWhereTheImageLeadsItNowhere) {
  PhantomSettings s = small_phantom("torus");
  s.radius = {10.0, 4.0};
  s.size = {36, 36, 24};
  Phantom phantom = make_phantom(s);
  RandomEngine random(11);
  for (float& v : phantom.image.voxels) v = static_cast<float>(50.0 + 10.0 * random.normal());
  FitOptions settings;
  settings.model.kind = ModelKind::slime;
  const Surface start = surface_from_mask(phantom.truth, settings.model, 2);
  const FitResult result = fit_surface({phantom.image, {Seed(start)}}, settings);
  EXPECT_NE(result.summary.status, FitStatus::ok);
  EXPECT_GE(dice(result.surface, phantom.truth), 0.93) << result.summary.reason;
}

TEST(GeometryCache, TellsControlMeshesOfEqualCountsApart) {
  const CatmullClarkModel cube = CatmullClarkModel::start();
  // The same cube with two corners' numbers exchanged, and with a longer reference.
  std::vector<Quad> quads = cube.topology().quads;
  for (Quad& quad : quads) {
    for (int& v : quad) v = v == 0 ? 1 : v == 1 ? 0 : v;
  }
  QuadReference renumbered = cube.reference_shape(), longer{cube.reference(), false};
  std::swap_ranges(renumbered.points.begin(), renumbered.points.begin() + 3, renumbered.points.begin() + 3);
  for (std::size_t i = 2; i < longer.points.size(); i += 3) longer.points[i] *= 3.0;
  const SurfaceModel models[] = {cube, CatmullClarkModel(8, quads, renumbered),
                                 CatmullClarkModel(8, cube.topology().quads, longer)};
  GeometryCache cache;
  RandomEngine random(4);
  Parameters parameters(24);
  for (double& p : parameters) p = random.uniform(-1.0, 1.0);
  for (const SurfaceModel& model : models) {
    const SampleLayout& kept = cache.get(model, 2).layout;
    const SampleLayout own = layout_of(model, 2);
    SurfaceSamples by_cache, by_model;
    evaluate(model, parameters, kept, false, by_cache);
    evaluate(model, parameters, own, false, by_model);
    EXPECT_EQ(by_cache.x, by_model.x);
    EXPECT_EQ(kept.reference, own.reference);
  }
}

}  // namespace
}  // namespace pellicle
