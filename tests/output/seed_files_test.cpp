#include <gtest/gtest.h>

#include "../all_grids.h"
#include "pellicle/output/seed_files.h"

namespace pellicle {
namespace {

TEST(Coords, AllFramesNameTheSamePlace) {
  for (const auto& grid : test::all_grids()) {
    const Vec3 index(3, 7, 11), lps = grid.world_from_index(index);
    EXPECT_LE((world_from_coords(index, Coords::ijk, grid) - lps).norm(), 1e-12);
    EXPECT_LE((world_from_coords(lps, Coords::lps, grid) - lps).norm(), 1e-12);
    EXPECT_LE((world_from_coords({-lps.x(), -lps.y(), lps.z()}, Coords::ras, grid) - lps).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace pellicle
