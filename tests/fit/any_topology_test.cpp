// Models over quad control meshes in whole fits, and masks with handles as seeds.

#include <gtest/gtest.h>

#include "fit_cases.h"

namespace pellicle {
namespace {

using namespace test;

class QuadModelFit : public testing::TestWithParam<ModelKind> {};
INSTANTIATE_TEST_SUITE_P(All, QuadModelFit, testing::Values(ModelKind::catmull_clark, ModelKind::slime));

TEST_P(QuadModelFit, FindsAnEllipsoidFromABall) {
  PhantomSettings s = small_phantom("ellipsoid");
  s.radius = {14, 11, 9};
  const Phantom phantom = make_phantom(s);
  FitSettings settings;
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

}  // namespace
}  // namespace pellicle
