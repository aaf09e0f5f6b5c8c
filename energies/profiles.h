#pragma once
/// Image profiles along the surface normals, and robust statistics of them.

#include <vector>

#include "pellicle/image/scalar_field.h"

namespace pellicle {

/// Row i holds I(x_i + (first + k step) n_i), k = 0..count-1; NaN outside the image. Lengths in mm.
struct Profiles {
  double first = 0.0, step = 1.0;
  int count = 0;
  std::vector<float> values;

  const float* row(std::size_t i) const { return values.data() + i * static_cast<std::size_t>(count); }
  double position(int k) const { return first + step * k; }
};

/// \param inside, outside how far the profiles reach from the surface, mm, both positive.
Profiles sample_profiles(const TrilinearField& image, const std::vector<Vec3>& x, const std::vector<Vec3>& normal,
                         double inside, double outside, double step);

/// Median of the finite values of a row with position in [from, to] mm; NaN when there are none.
double band_median(const Profiles& profiles, std::size_t row, double from, double to);

/// Median of the finite values; NaN when there are none. Reorders its argument.
double median_of(std::vector<double> values);
/// Value at a share 0..1 of the sorted finite values; NaN when there are none.
double quantile_of(std::vector<double> values, double share);
/// 1.4826 times the median absolute deviation.
double robust_deviation(const std::vector<double>& values);

}  // namespace pellicle
