#include "pellicle/surface/spline/spline_axis.h"

#include <algorithm>
#include <cmath>

namespace pellicle {

AxisWeights SplineAxis::at(double knots) const {
  if (closed_) knots -= m_ * std::floor(knots / m_);
  AxisWeights result;
  result.cell = std::clamp(static_cast<int>(std::floor(knots)), 0, m_ - 1);
  for (int a = 0; a < 4; ++a) {
    const int k = result.cell - 1 + a;
    const GeneratorValue phi = phi_.at(knots - k);
    const auto slot = static_cast<std::size_t>(a);
    result.row[slot] = row(k);
    result.value[slot] = phi.value;
    result.slope[slot] = m_ * phi.first;
  }
  return result;
}

}  // namespace pellicle
