#include "pellicle/energies/profiles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "pellicle/base/parallel.h"

namespace pellicle {

Profiles sample_profiles(const TrilinearField& image, std::span<const Vec3> x, std::span<const Vec3> n, double inside,
                         double outside, double step) {
  Profiles p;
  // Both sides are whole steps, so that the surface itself is a sample.
  const int before = static_cast<int>(std::ceil(inside / step - 1e-9)),
            after = static_cast<int>(std::ceil(outside / step - 1e-9));
  p.first = -before * step;
  p.step = step;
  p.count = before + after + 1;
  p.values.resize(x.size() * static_cast<std::size_t>(p.count));
  parallel_for(x.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      image.along_line(x[i] + p.first * n[i], step * n[i], p.count,
                       p.values.data() + i * static_cast<std::size_t>(p.count));
    }
  });
  return p;
}

std::vector<double> values_inside(const TrilinearField& image, std::span<const Vec3> x, const Vec3& centre,
                                  std::size_t stride) {
  std::vector<double> values;
  values.reserve(12 * (x.size() / stride + 1));
  for (int shell = 0; shell < 12; ++shell) {
    const double scale = std::cbrt((shell + 0.5) / 12.0);
    for (std::size_t i = 0; i < x.size(); i += stride) {
      values.push_back(static_cast<double>(image.at(centre + scale * (x[i] - centre))));
    }
  }
  return values;
}

double band_median(const Profiles& profiles, std::size_t row, double from, double to) {
  const int begin = std::max(0, static_cast<int>(std::ceil((from - profiles.first) / profiles.step - 1e-9)));
  const int end =
      std::min(profiles.count - 1, static_cast<int>(std::floor((to - profiles.first) / profiles.step + 1e-9)));
  std::array<float, 256> buffer;
  std::size_t n = 0;
  for (int k = begin; k <= end && n < buffer.size(); ++k) {
    const float v = profiles.row(row)[k];
    if (!std::isnan(v)) buffer[n++] = v;
  }
  if (n == 0) return std::numeric_limits<double>::quiet_NaN();
  std::sort(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(n));
  return 0.5 * (static_cast<double>(buffer[(n - 1) / 2]) + static_cast<double>(buffer[n / 2]));
}

double quantile_of(std::vector<double> values, double fraction) {
  std::erase_if(values, [](double v) { return std::isnan(v); });
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const double position = fraction * static_cast<double>(values.size() - 1);
  const auto low = static_cast<std::ptrdiff_t>(position);
  std::nth_element(values.begin(), values.begin() + low, values.end());
  const double below = values[static_cast<std::size_t>(low)];
  const double beyond = position - static_cast<double>(low);
  if (beyond == 0.0) return below;
  const double above = *std::min_element(values.begin() + low + 1, values.end());
  return below + beyond * (above - below);
}

double median_of(std::vector<double> values) {
  return quantile_of(std::move(values), 0.5);
}

double robust_deviation(const std::vector<double>& values) {
  const double middle = median_of(values);
  std::vector<double> deviation;
  deviation.reserve(values.size());
  for (const double v : values) deviation.push_back(std::abs(v - middle));
  return 1.4826 * median_of(std::move(deviation));
}

}  // namespace pellicle
