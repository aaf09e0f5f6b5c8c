#include "pellicle/seed/blob_scale_space.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "pellicle/base/parallel.h"
#include "pellicle/image/resample.h"
#include "pellicle/image/scalar_field.h"

namespace pellicle {

namespace {

const double kScale = std::cbrt(2.0);                 // K
constexpr std::size_t kMostFieldVoxels = 16'000'000;  // of the field that scales are made of
constexpr double kSeedShare = 0.9;  // of the scale of a typical object: neighbours part, nucleoli do not
constexpr double kVoxelsPerRadius = 5.0, kVoxelsPerScale = 4.0;

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

/// Position of a share of all counts, in bins, linear within a bin.
double quantile_in_bins(const std::vector<std::size_t>& counts, double share) {
  double total = 0.0;
  for (const std::size_t c : counts) total += static_cast<double>(c);
  double left = share * total;
  for (std::size_t b = 0; b < counts.size(); ++b) {
    const auto here = static_cast<double>(counts[b]);
    if (here > 0.0 && left <= here) return static_cast<double>(b) + left / here;
    left -= here;
  }
  return static_cast<double>(counts.size());
}

/// Quantiles of all voxels, to 1/65536 of the range between the outermost ten thousandths.
std::vector<double> quantiles(const Image<float>& image, const std::vector<double>& shares) {
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
  values.reserve(shares.size());
  for (const double share : shares) {
    values.push_back(from + (to - from) * quantile_in_bins(counts, share) / static_cast<double>(kBins));
  }
  return values;
}

/// Median of second differences along an axis, as a standard deviation of white noise. Bins grow by 1/64 a factor e.
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

/// Covariance of white noise of unit variance a voxel after Gaussians of a and b.
double overlap(double a, double b, double voxel_volume) {
  return voxel_volume / std::pow(2.0 * std::numbers::pi * (a * a + b * b), 1.5);
}

double response_noise(const BlobField& field, double sigma) {
  const double a = sigma, b = kScale * sigma, volume = field.voxel_volume;
  return field.noise * std::sqrt(overlap(a, a, volume) + overlap(b, b, volume) - 2.0 * overlap(a, b, volume)) /
         (kScale - 1.0);
}

/// Voxels no larger than `spacing`, or those of the image.
Index3 factors_within(const ImageGrid& grid, double spacing) {
  Index3 factor{1, 1, 1};
  for (int a = 0; a < 3; ++a) {
    factor[static_cast<std::size_t>(a)] = std::max(1, static_cast<int>(spacing / grid.spacing[a] + 1e-6));
  }
  return factor;
}

Image<float> binned(const Image<float>& image, double spacing) {
  const Index3 factor = factors_within(image.grid, spacing);
  return factor == Index3{1, 1, 1} ? image : crop_and_bin(image, {{0, 0, 0}, image.grid.size}, factor);
}

Image<float> difference(Image<float> fine, const Image<float>& coarse) {
  const auto scale = static_cast<float>(1.0 / (kScale - 1.0));
  parallel_for(fine.voxels.size(), 1 << 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) fine.voxels[i] = scale * (fine.voxels[i] - coarse.voxels[i]);
  });
  return fine;
}

double further_blur(double from) {
  return from * std::sqrt(kScale * kScale - 1.0);
}

Index3 nearest_voxel(const ImageGrid& grid, const Vec3& x) {
  const Vec3 index = grid.index_from_world(x);
  Index3 at{};
  for (int a = 0; a < 3; ++a) {
    const auto axis = static_cast<std::size_t>(a);
    at[axis] = std::clamp(static_cast<int>(std::lround(index[a])), 0, grid.size[axis] - 1);
  }
  return at;
}

/// Largest value of the 27 voxels about one, that one left out when it is of this image.
float largest_around(const Image<float>& image, const Index3& at, bool with_own) {
  float largest = -std::numeric_limits<float>::infinity();
  const Index3& size = image.grid.size;
  for (int k = std::max(0, at[2] - 1); k <= std::min(size[2] - 1, at[2] + 1); ++k) {
    for (int j = std::max(0, at[1] - 1); j <= std::min(size[1] - 1, at[1] + 1); ++j) {
      for (int i = std::max(0, at[0] - 1); i <= std::min(size[0] - 1, at[0] + 1); ++i) {
        if (with_own || i != at[0] || j != at[1] || k != at[2]) largest = std::max(largest, image.at(i, j, k));
      }
    }
  }
  return largest;
}

struct Maximum {
  Index3 at{};
  float value = 0.0F;
};

/// How much noisier a response is where the image is continued beyond its border: smoothed over half as many voxels
/// along each axis that ends within about sigma.
double border_factor(const ImageGrid& grid, const Index3& at, double sigma) {
  double factor = 1.0;
  for (std::size_t a = 0; a < 3; ++a) {
    const int steps = std::min(at[a], grid.size[a] - 1 - at[a]);
    const double depth = steps * grid.spacing[static_cast<int>(a)] / (2.0 * sigma);
    factor *= 1.0 + std::exp(-depth * depth);
  }
  return factor;
}

/// Voxels above `threshold` (more at the border) and above all their neighbours, in the order of storage.
std::vector<Maximum> maxima_of(const Image<float>& image, double threshold, double sigma) {
  const Index3& size = image.grid.size;
  std::vector<std::vector<Maximum>> slices(static_cast<std::size_t>(size[2]));
  parallel_for(slices.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      for (int j = 0; j < size[1]; ++j) {
        for (int i = 0; i < size[0]; ++i) {
          const Index3 at{i, j, static_cast<int>(k)};
          const float value = image.at(i, j, at[2]);
          if (!(static_cast<double>(value) > threshold) || !(value > largest_around(image, at, false))) continue;
          if (static_cast<double>(value) > threshold * border_factor(image.grid, at, sigma)) {
            slices[k].push_back({at, value});
          }
        }
      }
    }
  });
  std::vector<Maximum> all;
  for (const auto& slice : slices) all.insert(all.end(), slice.begin(), slice.end());
  return all;
}

/// One scale: its response and its place in the ladder.
struct Scale {
  double radius = 0.0;
  Image<float> response;
};

/// The response at ever larger radii, each on voxels of a quarter of its radius.
class Ladder {
 public:
  explicit Ladder(const BlobField& field) : field_(field) {}
  Scale at(double radius) {
    const double sigma = radius / std::sqrt(3.0);
    const Index3 factor = factors_within(field_.v.grid, radius / kVoxelsPerScale);
    if (!(factor == factor_) || std::abs(sigma / sigma_ - 1.0) > 1e-9) {
      smooth_ = gaussian_smooth(binned(field_.v, radius / kVoxelsPerScale), sigma);
      factor_ = factor;
    }
    Image<float> next = gaussian_smooth(smooth_, further_blur(sigma));
    Scale scale{radius, difference(std::move(smooth_), next)};
    smooth_ = std::move(next);
    sigma_ = kScale * sigma;
    return scale;
  }

 private:
  const BlobField& field_;
  Image<float> smooth_;
  Index3 factor_{0, 0, 0};
  double sigma_ = 1.0;
};

/// Sum of N^2 r^2 over the maxima of `here` that the neighbouring scales do not exceed.
double weight_of_scale(const BlobField& field, const Scale& here, const Scale& smaller, const Scale& larger) {
  const double sigma = here.radius / std::sqrt(3.0);
  double weight = 0.0;
  for (const Maximum& m : maxima_of(here.response, 6.0 * response_noise(field, sigma), sigma)) {
    const Vec3 x = here.response.grid.world_from_index(Vec3(m.at[0], m.at[1], m.at[2]));
    const auto exceeds = [&](const Scale& other) {
      return largest_around(other.response, nearest_voxel(other.response.grid, x), true) > m.value;
    };
    if (exceeds(smaller) || exceeds(larger)) continue;
    weight += static_cast<double>(m.value) * static_cast<double>(m.value) * here.radius * here.radius;
  }
  return weight;
}

/// Gaussian of 0.7 bins, then the highest bin and the parabola through it and its neighbours; -1 for nothing.
double mode_of(const std::vector<double>& weights) {
  const auto n = static_cast<int>(weights.size());
  const auto smoothed = [&](int i) {
    double value = 0.0;
    for (int j = std::max(0, i - 3); j <= std::min(n - 1, i + 3); ++j) {
      value += std::exp(-0.5 * (i - j) * (i - j) / 0.49) * weights[static_cast<std::size_t>(j)];
    }
    return value;
  };
  int best = 0;
  for (int i = 1; i < n; ++i) best = smoothed(i) > smoothed(best) ? i : best;
  const double here = smoothed(best);
  if (!(here > 0.0)) return -1.0;
  if (best == 0 || best == n - 1) return best;
  const double before = smoothed(best - 1), after = smoothed(best + 1);
  const double bend = before - 2.0 * here + after;
  return best + (bend < 0.0 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0.0);
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

Image<float> blob_response(const BlobField& field, double radius, double share, double* noise) {
  const double sigma = share * radius / std::sqrt(3.0);
  if (noise != nullptr) *noise = response_noise(field, sigma);
  Image<float> fine = gaussian_smooth(binned(field.v, radius / kVoxelsPerRadius), sigma);
  const Image<float> coarse = gaussian_smooth(fine, further_blur(sigma));
  return difference(std::move(fine), coarse);
}

std::optional<double> estimate_radius(const BlobField& field, const std::optional<RadiusRange>& range) {
  const double smallest = 2.0 * field.v.grid.mean_spacing(), largest = field.v.grid.extent().minCoeff() / 2.5;
  // A maximum needs a smaller and a larger scale beside it: the ladder starts and ends one step beyond.
  const double from = (range ? range->min : smallest) / kScale, to = (range ? range->max : largest) * kScale * 1.001;
  Ladder ladder(field);
  std::vector<Scale> scales;  // the last three
  std::vector<double> radii, weights;
  for (double radius = from; radius <= to; radius *= kScale) {
    scales.push_back(ladder.at(radius));
    if (scales.size() < 3) continue;
    radii.push_back(scales[1].radius);
    weights.push_back(weight_of_scale(field, scales[1], scales[0], scales[2]));
    scales.erase(scales.begin());
  }
  if (weights.empty()) return std::nullopt;
  const double mode = mode_of(weights);
  if (mode < 0.0) return std::nullopt;
  const double radius = radii.front() * std::pow(kScale, mode);
  return range ? std::clamp(radius, range->min, range->max) : radius;
}

std::vector<BlobSeed> find_blobs(const BlobField& field, double radius, const SeedRules& rules) {
  double noise = 0.0;
  const Image<float> response = blob_response(field, radius, kSeedShare, &noise);
  std::vector<Maximum> maxima = maxima_of(response, rules.deviations * noise, kSeedShare * radius / std::sqrt(3.0));
  if (maxima.empty()) return {};
  std::stable_sort(maxima.begin(), maxima.end(), [](const auto& a, const auto& b) { return a.value > b.value; });
  const auto strong = [&](double share) {
    return maxima[static_cast<std::size_t>((1.0 - share) * static_cast<double>(maxima.size() - 1))].value;
  };
  const float half = 0.5F * strong(0.98);
  const auto strong_count = static_cast<std::size_t>(
      std::count_if(maxima.begin(), maxima.end(), [&](const Maximum& m) { return m.value > half; }));
  const double reference = static_cast<double>(maxima[strong_count > 0 ? strong_count / 2 : 0].value);
  const TrilinearField values(response);
  std::vector<BlobSeed> seeds;
  std::map<std::array<int, 3>, std::vector<std::size_t>> cells;  // two radii wide
  const auto cell_of = [&](const Vec3& x) {
    std::array<int, 3> cell{};
    for (int a = 0; a < 3; ++a) cell[static_cast<std::size_t>(a)] = static_cast<int>(std::floor(x[a] / (2.0 * radius)));
    return cell;
  };
  const auto joined = [&](const BlobSeed& seed, const BlobSeed& other) {
    const double apart = (seed.position - other.position).norm();
    if (apart >= 2.0 * radius) return false;
    if (apart < 0.5 * radius) return true;
    std::array<float, 17> line{};
    values.along_line(seed.position, (other.position - seed.position) / 16.0, 17, line.data());
    return static_cast<double>(*std::min_element(line.begin(), line.end())) > rules.valley * seed.response;
  };
  for (const Maximum& m : maxima) {
    if (!(static_cast<double>(m.value) > rules.relative * reference)) break;
    const BlobSeed seed{response.grid.world_from_index(Vec3(m.at[0], m.at[1], m.at[2])), static_cast<double>(m.value)};
    const auto cell = cell_of(seed.position);
    bool taken = false;
    for (int n = 0; n < 27 && !taken; ++n) {
      const auto near = cells.find({cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1});
      if (near == cells.end()) continue;
      for (const std::size_t other : near->second) taken = taken || joined(seed, seeds[other]);
    }
    if (taken) continue;
    cells[cell].push_back(seeds.size());
    seeds.push_back(seed);
  }
  return seeds;
}

}  // namespace pellicle
