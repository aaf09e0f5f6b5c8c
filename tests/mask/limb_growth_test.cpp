#include "pellicle/mask/limb_growth.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "pellicle/base/random.h"
#include "pellicle/mask/components.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/raster/rasterize.h"
#include "pellicle/seed/voxel_seed.h"

namespace pellicle {
namespace {

constexpr std::uint8_t kAll = 0xFF;

std::uint32_t cells(std::initializer_list<int> bits) {
  std::uint32_t out = 0;
  for (const int b : bits) out |= 1U << b;
  return out;
}

TEST(SimplePoint, TellsTheCasesOfTheTextbook) {
  EXPECT_FALSE(is_simple(0));                                  // a part of its own
  EXPECT_TRUE(is_simple(cells({12})));                         // grows from a face
  EXPECT_FALSE(is_simple(cells({12, 14})));                    // joins two parts
  EXPECT_TRUE(is_simple(cells({12, 9, 10})));                  // beside a corner
  EXPECT_FALSE(is_simple(cells({12, 10})));                    // joins two that only share an edge
  EXPECT_FALSE(is_simple((1U << 27) - 1U));                    // opens a cavity
  EXPECT_TRUE(is_simple(cells({0, 1, 2, 3, 4, 5, 6, 7, 8})));  // on a plane
  EXPECT_FALSE(is_simple(cells({0})));                         // a corner alone does not join by faces
}

// Against counts of the whole little image: an isolated block of 3 x 3 x 3 voxels has the same parts and
// Euler number with and without its middle where that is simple.
TEST(SimplePoint, KeepsPartsAndEulerNumberOfRandomBlocks) {
  RandomEngine random(11);
  int simple = 0;
  for (int round = 0; round < 400; ++round) {
    const auto inside = static_cast<std::uint32_t>(random.next() & ((1U << 27) - 1U)) & ~(1U << 13);
    if (!is_simple(inside)) continue;
    ++simple;
    ImageGrid grid;
    grid.size = {5, 5, 5};
    const auto parts_and_euler = [&](bool with_middle) {
      Image<std::uint8_t> image(grid);
      for (int bit = 0; bit < 27; ++bit) {
        if ((inside >> bit & 1U) != 0) image.at(bit % 3 + 1, bit / 3 % 3 + 1, bit / 9 + 1) = 1;
      }
      if (with_middle) image.at(2, 2, 2) = 1;
      // Cells of the open object (object by faces): voxels - faces + edges - vertices that lie wholly inside.
      int euler = 0;
      for (int k = 0; k < 5; ++k) {
        for (int j = 0; j < 5; ++j) {
          for (int i = 0; i < 5; ++i) {
            for (int span = 0; span < 8; ++span) {
              bool whole = true;
              for (int c = 0; c < 8; ++c) {
                if ((c & ~span) != 0) continue;
                const int x = i + (c & 1), y = j + (c >> 1 & 1), z = k + (c >> 2 & 1);
                whole = whole && x < 5 && y < 5 && z < 5 && image.at(x, y, z) != 0;
              }
              if (whole) euler += std::popcount(static_cast<unsigned>(span)) % 2 == 0 ? 1 : -1;
            }
          }
        }
      }
      return std::pair(components_of(image).parts.size(), euler);
    };
    EXPECT_EQ(parts_and_euler(true), parts_and_euler(false)) << inside;
  }
  EXPECT_GT(simple, 10);
}

TEST(LimbGrowth, FollowsAThinLimbToItsTipAndClosesNoRing) {
  ImageGrid grid;
  grid.size = {40, 40, 9};
  Image<std::uint8_t> mask(grid), octants(grid);
  for (int k = 2; k < 7; ++k) {
    for (int j = 2; j < 10; ++j) {
      for (int i = 2; i < 10; ++i) mask.at(i, j, k) = octants.at(i, j, k) = kAll;
    }
  }
  for (auto& v : mask.voxels) v = v != 0 ? 1 : 0;
  for (int t = 10; t < 35; ++t) octants.at(t, t, 4) = kAll;  // by corners only
  // A thread from the body and back to it.
  for (int j = 6; j < 20; ++j) octants.at(2, j, 4) = octants.at(8, j, 4) = kAll;
  for (int i = 2; i < 9; ++i) octants.at(i, 19, 4) = kAll;
  grow_along_limbs(mask, octants);
  EXPECT_EQ(mask.at(34, 34, 4), 1);
  EXPECT_EQ(components_of(mask).parts.size(), 1U);
  EXPECT_EQ(topology_of(surface_of_mask(mask)).genus, 0);
  EXPECT_EQ(mask.at(20, 30, 4), 0);  // nothing where the object is not
}

TEST(VoxelsOfMask, KeepALimbThinnerThanHalfAVoxel) {
  ImageGrid grid;
  grid.size = {60, 24, 24};
  Image<std::uint8_t> mask(grid);
  for (int k = 0; k < 24; ++k) {
    for (int j = 0; j < 24; ++j) {
      for (int i = 0; i < 60; ++i) {
        const bool ball = Vec3(i - 12, j - 12, k - 12).norm() < 9.0;
        const bool limb = i >= 12 && i < 55 && std::abs(j - 12) <= 1 && std::abs(k - 12) <= 1;
        mask.at(i, j, k) = ball || limb ? 1 : 0;
      }
    }
  }
  const VoxelSeed seed = voxel_seed_of_voxels(voxels_of_mask(mask, 6.0, 0.5, Limbs::followed));
  EXPECT_EQ(seed.genus, 0);
  double reach = 0.0;
  for (const Vec3& x : seed.mesh.vertices) reach = std::max(reach, x.x());
  EXPECT_GT(reach, 47.0);
  for (const Vec3& x : voxel_seed_of_mask(mask, 6.0).mesh.vertices) EXPECT_LT(x.x(), 30.0);
}

}  // namespace
}  // namespace pellicle
