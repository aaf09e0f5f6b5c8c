#pragma once
/// Points as constant weighted sums of other points: one step of a subdivision, limit masks, stiffness in factors.

#include <vector>

#include "pellicle/base/geometry.h"

namespace pellicle {

/// Row r is sum_k weight[k] x[index[k]] for k in [start[r], start[r + 1]). An index may come more than once in a row.
struct PointRows {
  std::vector<int> start{0}, index;
  std::vector<double> weight;

  std::size_t size() const { return start.size() - 1; }
  void add(int i, double w) {
    index.push_back(i);
    weight.push_back(w);
  }
  void close() { start.push_back(static_cast<int>(index.size())); }
  Vec3 apply(std::size_t row, const std::vector<Vec3>& x) const {
    Vec3 sum = Vec3::Zero();
    for (auto k = static_cast<std::size_t>(start[row]); k < static_cast<std::size_t>(start[row + 1]); ++k) {
      sum += weight[k] * x[static_cast<std::size_t>(index[k])];
    }
    return sum;
  }
  std::vector<Vec3> apply(const std::vector<Vec3>& x) const {
    std::vector<Vec3> result(size());
    for (std::size_t row = 0; row < size(); ++row) result[row] = apply(row, x);
    return result;
  }
};

}  // namespace pellicle
