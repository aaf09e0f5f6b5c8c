// Affines: nearest rotation, shear, and one anatomy in five storage orders.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "corpus.h"
#include "pellicle/base/errors.h"
#include "pellicle/image/files/internal/affine_grid.h"
#include "pellicle/image/files/volume_file.h"

namespace pellicle {
namespace {

namespace fs = std::filesystem;

Mat3 random_rotation(std::mt19937& engine) {
  std::normal_distribution<double> normal;
  return Eigen::Quaterniond(normal(engine), normal(engine), normal(engine), normal(engine))
      .normalized()
      .toRotationMatrix();
}

TEST(NearestRotation, IsOrthogonalAndNoOtherIsNearer) {
  std::mt19937 engine(7);
  std::normal_distribution<double> normal(0.0, 0.05);
  for (int trial = 0; trial < 50; ++trial) {
    Mat3 m = random_rotation(engine);
    if (trial % 2 == 1) m.col(0) *= -1.0;
    m += Mat3::NullaryExpr([&] { return normal(engine); });
    const Mat3 r = nearest_rotation(m);
    EXPECT_LE((r.transpose() * r - Mat3::Identity()).norm(), 1e-13);
    EXPECT_GT(r.determinant() * m.determinant(), 0.0);
    for (int other = 0; other < 20; ++other) {
      const Vec3 axis = Vec3::NullaryExpr([&] { return normal(engine); });
      const Mat3 turned = Eigen::AngleAxisd(axis.norm(), axis.normalized()).toRotationMatrix() * r;
      EXPECT_LE((r - m).norm(), (turned - m).norm());
    }
  }
}

TEST(NearestRotation, KeepsSignedPermutationsBitForBit) {
  Mat3 m;
  m << 0, 0, -1, 1, 0, 0, 0, -1, 0;
  EXPECT_EQ(nearest_rotation(m), m);
}

Mat3 skewed_by(double degrees) {
  const double angle = degrees * std::numbers::pi / 180.0;
  Mat3 m = Mat3::Identity();
  m.col(1) << 2.0 * std::sin(angle), 2.0 * std::cos(angle), 0.0;
  return m;
}

TEST(GridFromAffine, WarnsOfSkewAndRefusesShear) {
  std::vector<std::string> warnings;
  const ImageGrid plain = grid_from_affine("x", {9, 9, 9}, skewed_by(0.001), Vec3::Zero(), warnings);
  EXPECT_TRUE(warnings.empty());
  EXPECT_NEAR(plain.spacing[1], 2.0, 1e-12);
  grid_from_affine("x", {9, 9, 9}, skewed_by(0.5), Vec3::Zero(), warnings);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find("0.500 degrees"), std::string::npos) << warnings[0];
  EXPECT_THROW(grid_from_affine("x", {9, 9, 9}, skewed_by(1.5), Vec3::Zero(), warnings), BadData);
}

TEST(GridFromAffine, RefusesWhatIsNoFrame) {
  std::vector<std::string> warnings;
  Mat3 flat = Mat3::Identity();
  flat.col(2).setZero();
  EXPECT_THROW(grid_from_affine("x", {9, 9, 9}, flat, Vec3::Zero(), warnings), BadData);
  Mat3 parallel = Mat3::Identity();
  parallel.col(2) = parallel.col(1);
  EXPECT_THROW(grid_from_affine("x", {9, 9, 9}, parallel, Vec3::Zero(), warnings), BadData);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(grid_from_affine("x", {9, 9, 9}, Mat3::Identity() * nan, Vec3::Zero(), warnings), BadData);
  EXPECT_THROW(grid_from_affine("x", {9, 9, 9}, Mat3::Identity(), Vec3(0, nan, 0), warnings), BadData);
  EXPECT_NO_THROW(
      grid_from_affine("x", {9, 9, 9}, 1e-6 * Mat3::Identity(), Vec3::Zero(), warnings));  // tiny is not singular
}

// Each voxel of one order lies on a voxel of every other order and has its value.
TEST(StorageOrder, OneAnatomyInFiveOrdersIsOneVolumeInTheWorld) {
  const fs::path made = test::shared_folder() / "data/bad-and-odd/made";
  if (!fs::exists(made)) GTEST_SKIP() << "no volumes at " << made;
  const Volume reference = read_volume(made / "reoriented_LPS_image.nii.gz");
  for (const char* order : {"ASL", "IAL", "LAS", "PSR"}) {
    SCOPED_TRACE(order);
    const Volume other = read_volume(made / ("reoriented_" + std::string(order) + "_image.nii.gz"));
    ASSERT_EQ(other.image.voxels.size(), reference.image.voxels.size());
    const Index3 size = reference.image.grid.size;
    double farthest = 0.0;
    std::size_t different = 0;
    for (int k = 0; k < size[2]; ++k) {
      for (int j = 0; j < size[1]; ++j) {
        for (int i = 0; i < size[0]; ++i) {
          const Vec3 there = other.image.grid.index_from_world(reference.image.grid.world_from_index(Vec3(i, j, k)));
          const Vec3 whole = there.array().round();
          farthest = std::max(farthest, (there - whole).norm());
          ASSERT_TRUE(other.image.grid.contains(other.image.grid.world_from_index(whole)));
          const float value =
              other.image.at(static_cast<int>(whole[0]), static_cast<int>(whole[1]), static_cast<int>(whole[2]));
          different += value != reference.image.at(i, j, k) ? 1U : 0U;
        }
      }
    }
    EXPECT_LE(farthest, 1e-5);
    EXPECT_EQ(different, 0U);
  }
}

}  // namespace
}  // namespace pellicle
