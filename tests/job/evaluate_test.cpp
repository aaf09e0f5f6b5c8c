// Metrics against closed forms of balls.
#include "pellicle/job/evaluate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pellicle/base/errors.h"
#include "pellicle/surface/surface.h"

namespace pellicle {
namespace {

TriangleMesh ball_mesh(const Vec3& center, double radius) {
  const NormalModel model = NormalModel::start(StartSolid::icosahedron, SubdivisionRule::smooth);
  return tessellate({model, affine_image(model, center, radius * Mat3::Identity())}, 5);
}

Image<std::int32_t> ball_labels(const Vec3& center, double radius, int label) {
  ImageGrid grid;
  grid.size = {70, 64, 40};
  grid.spacing = {0.5, 0.5, 0.8};
  grid.origin_in_world = {-17.25, -15.75, -15.6};
  Image<std::int32_t> labels(grid);
  for (int k = 0; k < grid.size[2]; ++k) {
    for (int j = 0; j < grid.size[1]; ++j) {
      for (int i = 0; i < grid.size[0]; ++i) {
        if ((grid.world_from_index(Vec3(i, j, k)) - center).norm() < radius) labels.at(i, j, k) = label;
      }
    }
  }
  return labels;
}

EvaluationInput mesh_input(const Vec3& center, double radius) {
  return {"mesh.ply", "mesh", {}, ball_mesh(center, radius), {}};
}
EvaluationInput mask_input(const Vec3& center, double radius, int label = 1) {
  return {"mask.nii", "label map", ball_labels(center, radius, label), {}, {}};
}

// Dice of two balls of one radius whose centres are d apart: the lens 4/3 pi R^3 (1 - 3t/2 + t^3/2), t = d / 2R.
double lens_dice(double radius, double d) {
  const double t = d / (2.0 * radius);
  return 1.0 - 1.5 * t + 0.5 * t * t * t;
}

TEST(Evaluate, ConcentricBallsAsMeshes) {
  const Evaluation e = evaluate_result(mesh_input({1, 2, 3}, 10), mesh_input({1, 2, 3}, 11), 0.9, false);
  EXPECT_NEAR(e.whole.dice, 2.0 * 1000 / (1000 + 1331), 0.003);
  EXPECT_NEAR(*e.whole.volume_error, 0.331, 0.002);
  ASSERT_TRUE(e.whole.distances);
  EXPECT_NEAR(e.whole.distances->assd, 1.0, 0.01);
  EXPECT_NEAR(e.whole.distances->hd, 1.0, 0.02);
  EXPECT_NEAR(e.whole.distances->hd95, 1.0, 0.02);
  EXPECT_EQ(e.whole.distances->nsd, 0.0);
  const Evaluation wide = evaluate_result(mesh_input({1, 2, 3}, 10), mesh_input({1, 2, 3}, 11), 1.1, false);
  EXPECT_EQ(wide.whole.distances->nsd, 1.0);
}

TEST(Evaluate, ShiftedBallsInEveryMixOfKinds) {
  const Vec3 shift(3, 0, 0);
  const std::vector<EvaluationInput> truths{mesh_input({0, 0, 0}, 10), mask_input({0, 0, 0}, 10)};
  const std::vector<EvaluationInput> results{mesh_input(shift, 10), mask_input(shift, 10)};
  for (const auto& truth : truths) {
    for (const auto& result : results) {
      const Evaluation e = evaluate_result(truth, result, 1.0, false);
      EXPECT_NEAR(e.whole.dice, lens_dice(10, 3), 0.005) << truth.kind << " " << result.kind;
      EXPECT_NEAR(e.whole.volume_error.value_or(9), 0.0, 0.005);
      ASSERT_TRUE(e.whole.distances);
      // |x - shift| - R over one ball, averaged: 1.5 + R/20 ... measured from the integral of ||x| - R| below.
      double sum = 0.0;
      constexpr int n = 100000;
      for (int i = 0; i < n; ++i) {  // uniform in cos(theta): Archimedes
        const double c = -1.0 + 2.0 * (i + 0.5) / n;
        sum += std::abs(std::sqrt(100.0 + 9.0 + 60.0 * c) - 10.0);
      }
      EXPECT_NEAR(e.whole.distances->assd, sum / n, 0.06);
      EXPECT_NEAR(e.whole.distances->hd, 3.0, 0.3);
    }
  }
}

TEST(Evaluate, EmptyMasksFollowTheRule) {
  const EvaluationInput full = mask_input({0, 0, 0}, 8), empty = mask_input({0, 0, 0}, 0);
  const Evaluation both = evaluate_result(empty, empty, 1.0, true);
  EXPECT_EQ(both.whole.dice, 1.0);
  EXPECT_FALSE(both.whole.distances);
  EXPECT_EQ(both.detection->f1, 1.0);
  const Evaluation missed = evaluate_result(full, empty, 1.0, true);
  EXPECT_EQ(missed.whole.dice, 0.0);
  EXPECT_EQ(*missed.whole.volume_error, -1.0);
  EXPECT_FALSE(missed.whole.distances);
  EXPECT_EQ(missed.detection->f1, 0.0);
  const Evaluation false_alarm = evaluate_result(empty, full, 1.0, true);
  EXPECT_FALSE(false_alarm.whole.volume_error);
  EXPECT_EQ(false_alarm.detection->false_positives, 1);
}

TEST(Evaluate, LabelsAndDetection) {
  EvaluationInput truth = mask_input({-6, 0, 0}, 5, 1), result = mask_input({-6, 0, 0}, 5, 7);
  const auto add = [](EvaluationInput& to, const Image<std::int32_t>& more) {
    for (std::size_t i = 0; i < more.voxels.size(); ++i) {
      if (more.voxels[i] != 0) to.labels->voxels[i] = more.voxels[i];
    }
  };
  add(truth, ball_labels({8, 0, 0}, 4, 2));
  add(result, ball_labels({11, 0, 0}, 4, 2));  // IoU far below one half
  const Evaluation e = evaluate_result(truth, result, 1.0, true);
  ASSERT_EQ(e.labels.size(), 3U);  // 1, 2 and 7
  EXPECT_EQ(e.labels[0].agreement.dice, 0.0);
  EXPECT_EQ(e.labels[0].best_match, 7);
  EXPECT_EQ(e.labels[0].best_iou, 1.0);
  EXPECT_NEAR(e.labels[1].agreement.dice, lens_dice(4, 3), 0.03);
  EXPECT_EQ(e.detection->true_positives, 1);
  EXPECT_EQ(e.detection->false_positives, 1);
  EXPECT_EQ(e.detection->false_negatives, 1);
  EXPECT_EQ(e.detection->f1, 0.5);
}

TEST(Evaluate, OtherGridIsAnError) {
  EvaluationInput a = mask_input({0, 0, 0}, 5), b = a;
  b.labels->grid.origin_in_world.x() += 1.0;
  EXPECT_THROW(evaluate_result(a, b, 1.0, false), BadData);
}

}  // namespace
}  // namespace pellicle
