#include "pellicle/seed/threshold.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace pellicle {

double threshold_of_two_classes(std::vector<float> values) {
  std::sort(values.begin(), values.end());
  const double lo = values[values.size() / 200], hi = values[values.size() - 1 - values.size() / 200];
  std::array<double, 256> histogram{};
  for (const float v : values) {
    const double bin = 255.0 * (std::clamp(static_cast<double>(v), lo, hi) - lo) / std::max(hi - lo, 1e-300);
    histogram[static_cast<std::size_t>(bin)] += 1.0;
  }
  double total = 0.0, weighted = 0.0;
  for (std::size_t b = 0; b < 256; ++b) {
    total += histogram[b];
    weighted += static_cast<double>(b) * histogram[b];
  }
  double below = 0.0, below_weighted = 0.0, best = -1.0, cut = 127.5;
  for (std::size_t b = 0; b < 255; ++b) {
    below += histogram[b];
    below_weighted += static_cast<double>(b) * histogram[b];
    if (below == 0.0 || below == total) continue;
    const double difference = below_weighted / below - (weighted - below_weighted) / (total - below);
    const double between = below * (total - below) * difference * difference;
    if (between > best) {
      best = between;
      cut = static_cast<double>(b) + 0.5;
    }
  }
  return lo + cut / 255.0 * (hi - lo);
}

}  // namespace pellicle
