#include "pellicle/image/orientation.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pellicle {

std::string orientation_code(const ImageGrid& grid) {
  // Best assignment of the three axes, not the largest entry of each: near 45 degrees two axes may prefer the same one.
  std::array<int, 3> order{0, 1, 2}, best = order;
  double best_sum = -1.0;
  do {
    double sum = 0.0;
    for (int a = 0; a < 3; ++a) sum += std::abs(grid.direction(order[static_cast<std::size_t>(a)], a));
    if (sum > best_sum + 1e-12) {
      best_sum = sum;
      best = order;
    }
  } while (std::next_permutation(order.begin(), order.end()));
  const std::string positive = "LPS", negative = "RAI";
  std::string code;
  for (int a = 0; a < 3; ++a) {
    const auto axis = static_cast<std::size_t>(best[static_cast<std::size_t>(a)]);
    code += grid.direction(best[static_cast<std::size_t>(a)], a) >= 0.0 ? positive[axis] : negative[axis];
  }
  return code;
}

}  // namespace pellicle
