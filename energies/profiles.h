#pragma once
/// Image profiles along the surface normals, and robust statistics of them.

#include <span>
#include <vector>

#include "pellicle/energies/sample_view.h"
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

/// Along lines that start at x, in unit directions n. \param inside, outside how far the profiles reach from x, mm,
/// both positive.
Profiles sample_profiles(const TrilinearField& image, std::span<const Vec3> x, std::span<const Vec3> n, double inside,
                         double outside, double step);
/// Along the normals of a surface.
inline Profiles sample_profiles(const TrilinearField& image, const SampleView& surface, double inside, double outside,
                                double step) {
  return sample_profiles(image, surface.x, surface.normal, inside, outside, step);
}

/// Values inside a star-shaped surface, from 12 layers of equal volume: copies of every `stride`th sample, shrunk
/// towards a centre. NaN where outside the image.
std::vector<double> values_inside(const TrilinearField& image, std::span<const Vec3> x, const Vec3& centre,
                                  std::size_t stride);

/// Median of the finite values of a row with position in [from, to] mm; NaN when there are none.
double band_median(const Profiles& profiles, std::size_t row, double from, double to);

/// Median of the finite values; NaN when there are none. Reorders its argument.
double median_of(std::vector<double> values);
/// Value at a fraction 0..1 of the sorted finite values; NaN when there are none.
double quantile_of(std::vector<double> values, double fraction);
/// 1.4826 times the median absolute deviation.
double robust_deviation(const std::vector<double>& values);

}  // namespace pellicle
