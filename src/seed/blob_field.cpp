// The field that blobs are looked for in: intensities whose noise is even, binned where the image is large.
#include <algorithm>
#include <cmath>
#include <limits>

#include "pellicle/base/parallel.h"
#include "pellicle/image/resample.h"
#include "pellicle/seed/blob_scale_space.h"

namespace pellicle {

namespace {

constexpr std::size_t kMostFieldVoxels = 16'000'000;  // of the field that scales are made of

/// Counts of values by bins; made in parallel, added up in order.
template <class F>
std::vector<std::size_t> histogram(int slices, std::size_t bins, const F& count_slice) {
  constexpr std::size_t kParts = 16;
  std::vector<std::vector<std::size_t>> parts(kParts, std::vector<std::size_t>(bins, 0));
  parallel_for(kParts, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      const auto first = static_cast<int>(p * static_cast<std::size_t>(slices) / kParts);
      const auto last = static_cast<int>((p + 1) * static_cast<std::size_t>(slices) / kParts);
      for (int k = first; k < last; ++k) count_slice(k, parts[p]);
    }
  });
  for (std::size_t p = 1; p < kParts; ++p) {
    for (std::size_t b = 0; b < bins; ++b) parts[0][b] += parts[p][b];
  }
  return parts[0];
}

/// Position below which a fraction of all counts lies, in bins, linear within a bin.
double quantile_in_bins(const std::vector<std::size_t>& counts, double fraction) {
  double total = 0.0;
  for (const std::size_t c : counts) total += static_cast<double>(c);
  double left = fraction * total;
  for (std::size_t b = 0; b < counts.size(); ++b) {
    const auto here = static_cast<double>(counts[b]);
    if (here > 0.0 && left <= here) return static_cast<double>(b) + left / here;
    left -= here;
  }
  return static_cast<double>(counts.size());
}

/// Quantiles of all voxels, to 1/65536 of the range between the outermost ten thousandths.
std::vector<double> quantiles(const Image<float>& image, const std::vector<double>& fractions) {
  constexpr std::size_t kBins = 65536;
  const auto [low, high] = std::minmax_element(image.voxels.begin(), image.voxels.end());
  double from = static_cast<double>(*low), to = static_cast<double>(*high);
  const std::size_t slice = image.voxels.size() / static_cast<std::size_t>(image.grid.size[2]);
  std::vector<std::size_t> counts;
  const auto count = [&] {
    const double scale = to > from ? static_cast<double>(kBins) / (to - from) : 0.0;
    counts = histogram(image.grid.size[2], kBins, [&](int k, std::vector<std::size_t>& part) {
      const float* data = image.voxels.data() + static_cast<std::size_t>(k) * slice;
      for (std::size_t i = 0; i < slice; ++i) {
        const double bin = (static_cast<double>(data[i]) - from) * scale;
        ++part[static_cast<std::size_t>(std::clamp(bin, 0.0, static_cast<double>(kBins - 1)))];
      }
    });
  };
  count();
  const double width = (to - from) / static_cast<double>(kBins);
  const double begin = std::floor(quantile_in_bins(counts, 1e-4)),
               end = std::ceil(quantile_in_bins(counts, 1.0 - 1e-4));
  to = from + width * (end + 1.0);
  from += width * (begin - 1.0);
  count();
  std::vector<double> values;
  values.reserve(fractions.size());
  for (const double fraction : fractions) {
    values.push_back(from + (to - from) * quantile_in_bins(counts, fraction) / static_cast<double>(kBins));
  }
  return values;
}

/// Median of second differences along an axis, as a standard deviation of white noise. 64 bins for each
/// factor e.
double noise_along(const Image<float>& image, const StableIntensity& intensity, int axis) {
  const Index3& size = image.grid.size;
  if (size[static_cast<std::size_t>(axis)] < 3) return std::numeric_limits<double>::infinity();
  constexpr double kPerFactor = 64.0, kSmallest = 1e-6;
  constexpr std::size_t kBins = 1600;
  const std::size_t step = axis == 0 ? 1 : image.grid.offset(0, axis == 1 ? 1 : 0, axis == 2 ? 1 : 0);
  const auto inner = [&](int i, int a) { return a != axis || (i > 0 && i < size[static_cast<std::size_t>(a)] - 1); };
  const auto counts = histogram(size[2], kBins, [&](int k, std::vector<std::size_t>& part) {
    if (!inner(k, 2)) return;
    for (int j = 0; j < size[1]; ++j) {
      if (!inner(j, 1)) continue;
      const float* row = &image.at(0, j, k);
      for (int i = axis == 0 ? 1 : 0; i < size[0] - (axis == 0 ? 1 : 0); ++i) {
        const float* p = row + i;
        const float second =
            intensity(p[-static_cast<std::ptrdiff_t>(step)]) - 2.0F * intensity(*p) + intensity(p[step]);
        const double bin = kPerFactor * std::log(std::abs(static_cast<double>(second)) / kSmallest + 1e-300);
        ++part[static_cast<std::size_t>(std::clamp(bin, 0.0, static_cast<double>(kBins - 1)))];
      }
    }
  });
  const double bin = quantile_in_bins(counts, 0.5);
  return bin < 1.0 ? 0.0 : 1.4826 / std::sqrt(6.0) * kSmallest * std::exp(bin / kPerFactor);
}

double noise_in(const Image<float>& image, const StableIntensity& intensity, double range) {
  // Along the finest axes: across thick slices the object itself changes.
  const double finest = image.grid.spacing.minCoeff();
  double noise = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    if (image.grid.spacing[axis] > 1.5 * finest) continue;
    noise = std::min(noise, noise_along(image, intensity, axis));
  }
  return std::max(std::isfinite(noise) ? noise : 0.0, 1e-3 * range);
}

}  // namespace

float StableIntensity::operator()(float intensity) const {
  const double above = static_cast<double>(linear(intensity)) - low;
  return static_cast<float>(std::sqrt(std::max(0.0, above) / unit + 1.0));
}

bool looks_dark(const Image<float>& image) {
  const auto q = quantiles(image, {0.005, 0.5, 0.995});
  return q[1] - q[0] > 2.0 * (q[2] - q[1]);
}

BlobField blob_field(const Image<float>& image, bool dark) {
  BlobField field;
  field.voxel_volume = image.grid.voxel_volume();
  const auto q = quantiles(image, {0.01, 0.002, 0.998, 0.99});
  field.intensity.dark = dark;
  field.intensity.low = dark ? -q[3] : q[0];
  const double range = dark ? q[3] - q[1] : q[2] - q[0];
  field.intensity.unit = range > 0.0 ? range / 256.0 : std::max(1e-30, q[2] - q[0]);
  field.noise = noise_in(image, field.intensity, 16.0);  // of v, whose range is about 16
  double spacing = image.grid.spacing.minCoeff();
  Index3 factor{1, 1, 1};
  const auto voxels = [&] {
    double count = 1.0;
    for (std::size_t a = 0; a < 3; ++a) count *= std::ceil(static_cast<double>(image.grid.size[a]) / factor[a]);
    return count;
  };
  while (voxels() > static_cast<double>(kMostFieldVoxels)) {
    spacing *= 1.25;
    factor = bin_factors(image.grid, spacing);
  }
  // Slab by slab: a copy of the whole image as v would cost more memory than all the rest.
  const IndexBox all{{0, 0, 0}, image.grid.size};
  ImageGrid grid = image.grid;
  for (std::size_t a = 0; a < 3; ++a) grid.size[a] = (image.grid.size[a] + factor[a] - 1) / factor[a];
  std::vector<Image<float>> slabs(static_cast<std::size_t>(grid.size[2]));
  parallel_for(slabs.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      IndexBox box = all;
      box.begin[2] = static_cast<int>(k) * factor[2];
      box.size[2] = std::min(factor[2], image.grid.size[2] - box.begin[2]);
      Image<float> slab = crop_and_bin(image, box, {1, 1, 1});
      for (float& value : slab.voxels) value = field.intensity(value);
      slabs[k] = factor == Index3{1, 1, 1}
                     ? std::move(slab)
                     : crop_and_bin(slab, {{0, 0, 0}, slab.grid.size}, {factor[0], factor[1], box.size[2]});
    }
  });
  grid.spacing = image.grid.spacing.cwiseProduct(Vec3(factor[0], factor[1], factor[2]));
  grid.origin_in_world = image.grid.world_from_index(0.5 * Vec3(factor[0] - 1, factor[1] - 1, factor[2] - 1));
  field.v.grid = grid;
  field.v.voxels.reserve(grid.voxel_count());
  for (auto& slab : slabs) {
    field.v.voxels.insert(field.v.voxels.end(), slab.voxels.begin(), slab.voxels.end());
    std::vector<float>().swap(slab.voxels);
  }
  return field;
}

}  // namespace pellicle
