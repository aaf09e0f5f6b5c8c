#include "pellicle/image/orientation.h"

#include <gtest/gtest.h>

#include "../all_grids.h"

namespace pellicle {
namespace {

TEST(Orientation, CodeNamesTheDirectionOfEachAxis) {
  for (const auto& grid : test::all_grids()) {
    const std::string code = orientation_code(grid);
    for (int a = 0; a < 3; ++a) {
      const Vec3 towards = grid.direction.col(a);
      const std::string letters = "LPSRAI";
      const auto at = letters.find(code[static_cast<std::size_t>(a)]);
      ASSERT_NE(at, std::string::npos);
      EXPECT_EQ(towards[static_cast<int>(at % 3)], at < 3 ? 1.0 : -1.0);
    }
  }
}

}  // namespace
}  // namespace pellicle
