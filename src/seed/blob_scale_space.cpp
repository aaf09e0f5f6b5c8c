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

const double kScale = std::cbrt(2.0);  // K
constexpr double kSeedScale = 0.9;     // times that of a typical object: neighbours part, nucleoli do not
constexpr double kVoxelsPerRadius = 5.0, kVoxelsPerScale = 4.0;

/// Covariance of white noise of unit variance per voxel after Gaussians of a and b.
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

/// Largest value of the 27 voxels about `at`, or of the 26 others.
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

/// Factor of the noise of a response near the border: the image is continued there, so that the response is a mean of
/// half as many voxels along each axis that ends within about sigma.
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

/// The response at one scale.
struct Scale {
  double radius = 0.0;
  Image<float> response;
};

/// Responses at growing radii, each on voxels of a quarter of its radius.
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

Image<float> blob_response(const BlobField& field, double radius, double scale, double* noise) {
  const double sigma = scale * radius / std::sqrt(3.0);
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
  const Image<float> response = blob_response(field, radius, kSeedScale, &noise);
  std::vector<Maximum> maxima = maxima_of(response, rules.deviations * noise, kSeedScale * radius / std::sqrt(3.0));
  if (maxima.empty()) return {};
  std::stable_sort(maxima.begin(), maxima.end(), [](const auto& a, const auto& b) { return a.value > b.value; });
  const auto strong = [&](double fraction) {
    return maxima[static_cast<std::size_t>((1.0 - fraction) * static_cast<double>(maxima.size() - 1))].value;
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
