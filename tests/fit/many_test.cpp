// Many objects on small phantoms.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "pellicle/base/parallel.h"
#include "pellicle/energies/body.h"
#include "pellicle/fit/many/many.h"
#include "pellicle/fit/stage.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/raster/joint_labels.h"
#include "pellicle/synthetic/cluster.h"

namespace pellicle {
namespace {

ClusterSettings few_nuclei(int count = 8, double distance = 1.0) {
  ClusterSettings s;
  s.image.size = {64, 64, 40};
  s.image.spacing = {0.8, 0.8, 1.2};
  s.image.snr = 8.0;
  s.image.blur_mm = 0.6;
  s.image.seed = 11;
  s.count = count;
  s.radius_min = 5.0;
  s.radius_max = 7.0;
  s.distance = distance;
  return s;
}

ManySettings catmull_clark() {
  ManySettings settings;
  settings.fit.model.kind = ModelKind::catmull_clark;
  return settings;
}

double volume(const Surface& surface) {
  return volume_with_normals(tessellate(surface, 3));
}

JointLabels labels_of(const ManyResult& result, const ImageGrid& grid) {
  std::vector<TriangleMesh> meshes;
  std::vector<const TriangleMesh*> pointers;
  std::vector<std::uint16_t> labels;
  meshes.reserve(result.objects.size());
  for (const ManyObject& object : result.objects) {
    meshes.push_back(tessellate(object.surface, 3));
    pointers.push_back(&meshes.back());
    labels.push_back(static_cast<std::uint16_t>(labels.size() + 1));
  }
  return label_together(pointers, labels, grid);
}

/// Dice of the label that overlaps each true one most.
std::vector<double> best_dice(const Image<std::uint16_t>& truth, const Image<std::uint16_t>& result) {
  const std::size_t n = 1U + *std::max_element(truth.voxels.begin(), truth.voxels.end()),
                    m = 1U + *std::max_element(result.voxels.begin(), result.voxels.end());
  std::vector<double> both(n * m, 0.0), of_truth(n, 0.0), of_result(m, 0.0);
  for (std::size_t i = 0; i < truth.voxels.size(); ++i) {
    both[truth.voxels[i] * m + result.voxels[i]] += 1.0;
    of_truth[truth.voxels[i]] += 1.0;
    of_result[result.voxels[i]] += 1.0;
  }
  std::vector<double> dice(n - 1, 0.0);
  for (std::size_t t = 1; t < n; ++t) {
    for (std::size_t r = 1; r < m; ++r) {
      dice[t - 1] = std::max(dice[t - 1], 2.0 * both[t * m + r] / (of_truth[t] + of_result[r]));
    }
  }
  return dice;
}

TEST(Many, EveryNucleusIsFoundAndFitted) {
  for (const double distance : {1.0, 0.9}) {
    const Cluster cluster = make_cluster(few_nuclei(8, distance));
    const ManyResult result = fit_many(cluster.image, catmull_clark());
    ASSERT_EQ(result.objects.size(), 8U);
    const JointLabels joint = labels_of(result, cluster.image.grid);
    EXPECT_THAT(best_dice(cluster.truth, joint.labels), testing::Each(testing::Ge(0.93)));
    for (const ManyObject& object : result.objects) {
      EXPECT_EQ(object.summary.status, FitStatus::ok) << object.summary.reason;
      EXPECT_GT(volume(object.surface), 0.0);
    }
  }
}

TEST(Many, VolumesAreUnbiased) {
  const Cluster cluster = make_cluster(few_nuclei());
  const ManyResult result = fit_many(cluster.image, catmull_clark());
  double truth = 0.0, fitted = 0.0;
  for (const Body& body : cluster.bodies) truth += exact_volume(body.shape);
  for (const ManyObject& object : result.objects) fitted += volume(object.surface);
  EXPECT_NEAR(fitted / truth, 1.0, 0.04);
}

TEST(Many, AnyModelFits) {
  const Cluster cluster = make_cluster(few_nuclei(3));
  for (const ModelKind kind : {ModelKind::normal, ModelKind::spline, ModelKind::slime}) {
    ManySettings settings;
    settings.fit.model.kind = kind;
    const ManyResult result = fit_many(cluster.image, settings);
    ASSERT_EQ(result.objects.size(), 3U) << static_cast<int>(kind);
    EXPECT_THAT(best_dice(cluster.truth, labels_of(result, cluster.image.grid).labels),
                testing::Each(testing::Ge(0.9)));
  }
}

TEST(Many, TheSameForAnyNumberOfThreads) {
  const Cluster cluster = make_cluster(few_nuclei(5));
  std::vector<Parameters> first;
  for (const int threads : {1, 3}) {
    const ThreadLimit limit(threads);
    const ManyResult result = fit_many(cluster.image, catmull_clark());
    std::vector<Parameters> all;
    for (const ManyObject& object : result.objects) all.push_back(object.surface.parameters);
    if (first.empty()) first = all;
    EXPECT_EQ(all, first);
  }
}

TEST(Many, PermutedAxesGivePermutedLabels) {
  const Cluster cluster = make_cluster(few_nuclei(5));
  const ImageGrid& grid = cluster.image.grid;
  ImageGrid turned = grid;
  turned.size = {grid.size[1], grid.size[2], grid.size[0]};
  turned.spacing = {grid.spacing[1], grid.spacing[2], grid.spacing[0]};
  turned.origin_in_world = {grid.origin_in_world[1], grid.origin_in_world[2], grid.origin_in_world[0]};
  Image<float> image(turned);
  for (int k = 0; k < grid.size[2]; ++k) {
    for (int j = 0; j < grid.size[1]; ++j) {
      for (int i = 0; i < grid.size[0]; ++i) image.at(j, k, i) = cluster.image.at(i, j, k);
    }
  }
  const JointLabels a = labels_of(fit_many(cluster.image, catmull_clark()), grid);
  const JointLabels b = labels_of(fit_many(image, catmull_clark()), turned);
  std::size_t differ = 0, inside = 0;
  for (int k = 0; k < grid.size[2]; ++k) {
    for (int j = 0; j < grid.size[1]; ++j) {
      for (int i = 0; i < grid.size[0]; ++i) {
        inside += a.labels.at(i, j, k) != 0 ? 1 : 0;
        differ += a.labels.at(i, j, k) != b.labels.at(j, k, i) ? 1 : 0;
      }
    }
  }
  EXPECT_GT(inside, 2000U);
  EXPECT_LE(differ, inside / 200);  // sums in another order move a voxel here and there
}

TEST(Many, TwoSeedsInOneObjectAreOne) {
  const Cluster cluster = make_cluster(few_nuclei(4));
  std::vector<Seed> seeds;
  for (const Body& body : cluster.bodies) seeds.emplace_back(SeedSphere{body.center, 5.0});
  seeds.emplace_back(SeedSphere{cluster.bodies[0].center + Vec3(1.0, 0.5, 0.0), 5.0});
  const ManyResult result = fit_many(cluster.image, seeds, catmull_clark());
  EXPECT_EQ(result.objects.size(), 4U);
  EXPECT_EQ(result.doubled, 1U);
}

TEST(Many, NothingIsFoundInNoise) {
  Image<float> image(ImageGrid{.size = {40, 40, 40}});
  RandomEngine random(4);
  for (float& v : image.voxels) v = static_cast<float>(50.0 + 5.0 * random.normal());
  EXPECT_TRUE(fit_many(image, catmull_clark()).objects.empty());
}

// A ball of 6 mm, level 1 inside, 0 outside, blurred by s: erf profile.
Image<float> blurred_ball(double s) {
  Image<float> image(ImageGrid{.size = {33, 33, 33}, .spacing = {0.5, 0.5, 0.5}, .origin_in_world = {-8, -8, -8}});
  for (int k = 0; k < 33; ++k) {
    for (int j = 0; j < 33; ++j) {
      for (int i = 0; i < 33; ++i) {
        // Radial profile of a blurred ball to first order in s/R: 1/2 erfc((r - R)/(sqrt2 s) + s/(sqrt2 R)).
        const double r = image.grid.world_from_index(Vec3(i, j, k)).norm();
        image.at(i, j, k) = static_cast<float>(0.5 * std::erfc(((r - 6.0) / s + s / 6.0) / std::sqrt(2.0)));
      }
    }
  }
  return image;
}

TEST(Body, BlurIsMeasuredAndTakenBack) {
  const Image<float> image = blurred_ball(0.8);
  const SurfaceModel model = CatmullClarkModel::start(1);
  GeometryCache cache;
  const StageGeometry& geometry = cache.get(model, 2);
  const Surface ball{model, affine_image(model, Vec3::Zero(), 5.6 * Mat3::Identity())};
  const SampledSurface samples(geometry.layout, ball);
  BodySearch search{.half_width = 0.5};
  const BodyReading plain = read_body(TrilinearField(image), samples, search);
  search.unblur = true;
  const BodyReading unblurred = read_body(TrilinearField(image), samples, search);
  EXPECT_NEAR(plain.blur, 0.8, 0.2);  // the window cuts the tails
  for (std::size_t i = 0; i < samples.x().size(); ++i) {
    EXPECT_LT(samples.x()[i].norm() + plain.targets.offset[i], 6.0);
    EXPECT_NEAR(samples.x()[i].norm() + unblurred.targets.offset[i], 6.0, 0.1);
    EXPECT_EQ(plain.limited[i], 0);
  }
}

TEST(Body, ProfilesEndAtTheTerritory) {
  // A rod along x; what lies at x >= 2 belongs to a neighbour.
  Image<float> bright(ImageGrid{.size = {33, 33, 33}, .spacing = {0.5, 0.5, 0.5}, .origin_in_world = {-8, -8, -8}});
  for (int k = 0; k < 33; ++k) {
    for (int j = 0; j < 33; ++j) {
      for (int i = 0; i < 33; ++i) bright.at(i, j, k) = std::hypot(0.5 * j - 8.0, 0.5 * k - 8.0) < 4.0 ? 1.0F : 0.0F;
    }
  }
  Image<float> territory(bright.grid, 1.0F);
  for (int k = 0; k < 33; ++k) {
    for (int j = 0; j < 33; ++j) {
      for (int i = 20; i < 33; ++i) territory.at(i, j, k) = 0.0F;  // x >= 2 belongs to a neighbour
    }
  }
  const SurfaceModel model = CatmullClarkModel::start(1);
  GeometryCache cache;
  const StageGeometry& geometry = cache.get(model, 2);
  const Surface rod{model, affine_image(model, Vec3(-2, 0, 0), 4.0 * Mat3::Identity())};
  const SampledSurface samples(geometry.layout, rod);
  const BodyReading reading = read_body(TrilinearField(bright), samples, {.half_width = 0.6, .territory = &territory});
  for (std::size_t i = 0; i < samples.x().size(); ++i) {
    if (samples.normal()[i][0] < 0.9) continue;
    const double x = (samples.x()[i] + reading.targets.offset[i] * samples.normal()[i])[0];
    EXPECT_LE(x, 2.3);
    EXPECT_EQ(reading.limited[i], 1);
  }
}

TEST(JointLabels, DisputedVoxelsGoToTheDeeper) {
  const ImageGrid grid{.size = {30, 20, 20}};
  const SurfaceModel model = CatmullClarkModel::start(2);
  const auto ball = [&](const Vec3& centre, double r) {
    return tessellate(Surface{model, affine_image(model, centre, r * Mat3::Identity())}, 3);
  };
  const TriangleMesh a = ball({10, 10, 10}, 6.0), b = ball({18, 10, 10}, 6.0);
  const JointLabels joint = label_together({&a, &b}, {7, 3}, grid);
  for (int k = 0; k < 20; ++k) {
    for (int j = 0; j < 20; ++j) {
      for (int i = 0; i < 30; ++i) {
        const int label = joint.labels.at(i, j, k);
        if (i < 14) {
          EXPECT_NE(label, 3);
        }
        if (i > 14) {
          EXPECT_NE(label, 7);
        }
      }
    }
  }
  EXPECT_EQ(joint.labels.at(10, 10, 10), 7);
  EXPECT_GT(joint.shared[0], 20U);
  EXPECT_EQ(joint.shared[0], joint.shared[1]);
  const auto count = [&](int label) {
    return static_cast<std::size_t>(std::count(joint.labels.voxels.begin(), joint.labels.voxels.end(), label));
  };
  EXPECT_EQ(joint.voxels[0], count(7));
  EXPECT_EQ(joint.voxels[1], count(3));
}

}  // namespace
}  // namespace pellicle
