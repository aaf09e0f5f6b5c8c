#include "pellicle/seed/rays.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "pellicle/base/parallel.h"
#include "pellicle/energies/geometry.h"
#include "pellicle/energies/profiles.h"

namespace pellicle {

namespace {
constexpr int kRays = 256;

std::vector<Vec3> fibonacci_directions(int count) {
  std::vector<Vec3> directions;
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count, r = std::sqrt(1.0 - z * z);
    directions.emplace_back(r * std::cos(golden * i), r * std::sin(golden * i), z);
  }
  return directions;
}

// Gaussian of one h along each ray (step h/2: sigma of two samples); NaN ends the ray.
void smooth_along(Profiles& rays) {
  constexpr int kRadius = 6;
  std::array<float, 2 * kRadius + 1> kernel{};
  float total = 0.0F;
  for (int k = -kRadius; k <= kRadius; ++k) {
    total += kernel[static_cast<std::size_t>(k + kRadius)] = std::exp(-0.125F * static_cast<float>(k * k));
  }
  for (float& w : kernel) w /= total;
  parallel_for(rays.values.size() / static_cast<std::size_t>(rays.count), 16, [&](std::size_t begin, std::size_t end) {
    std::vector<float> line;
    for (std::size_t i = begin; i < end; ++i) {
      float* row = rays.values.data() + i * static_cast<std::size_t>(rays.count);
      int valid = 0;
      while (valid < rays.count && !std::isnan(row[valid])) ++valid;
      line.assign(row, row + valid);
      for (int k = 0; k < valid; ++k) {
        float sum = 0.0F;
        for (int j = -kRadius; j <= kRadius; ++j) {
          sum += kernel[static_cast<std::size_t>(j + kRadius)] *
                 line[static_cast<std::size_t>(std::clamp(k + j, 0, valid - 1))];
        }
        row[k] = sum;
      }
    }
  });
}

// Response at sample k: the fall of sign * I across one h (step), or the height above both sides (ridge).
double response(const float* row, int k, double sign, bool ridge) {
  if (ridge) {
    constexpr int kSide = 6;  // 3 h
    if (k < kSide || std::isnan(row[k + kSide])) return 0.0;
    return std::min(row[k] - row[k - kSide], row[k] - row[k + kSide]);
  }
  return std::isnan(row[k + 1]) ? 0.0 : -sign * 0.5 * (row[k + 1] - row[k - 1]);
}

// First local maximum of the response that is at least half of `reference`; -1 when there is none.
int first_edge(const float* row, int count, double sign, bool ridge, double reference) {
  const int margin = ridge ? 7 : 2;
  for (int k = 1; k + margin < count; ++k) {
    const double here = response(row, k, sign, ridge);
    if (here >= 0.5 * reference && here >= response(row, k - (k > 1 ? 1 : 0), sign, ridge) &&
        here > response(row, k + 1, sign, ridge)) {
      return k;
    }
  }
  return -1;
}

// First and second moments of the star-shaped body with these radii: every ray stands for an equal solid angle.
void outline(const std::vector<Vec3>& directions, const std::vector<double>& radius, const Vec3& origin,
             RayReading& reading) {
  double volume = 0.0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const double r3 = std::pow(radius[i], 3);
    volume += r3 / 3.0;
    first += r3 * radius[i] / 4.0 * directions[i];
    second += r3 * radius[i] * radius[i] / 5.0 * directions[i] * directions[i].transpose();
  }
  const Vec3 mean = first / volume;
  const Mat3 covariance = second / volume - mean * mean.transpose();
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(covariance);
  // A solid ellipsoid with half-axis a has variance a^2/5 along it. Symmetric root: no arbitrary turn of the
  // parameters.
  const Vec3 axes = (5.0 * eigen.eigenvalues().cwiseMax(1e-12)).cwiseSqrt();
  reading.center = origin + mean;
  reading.shape = eigen.eigenvectors() * axes.asDiagonal() * eigen.eigenvectors().transpose();
}

RayReading read_one(const Profiles& rays, const std::vector<Vec3>& directions, const SeedSphere& seed, double core,
                    double sign, bool ridge) {
  const std::size_t n = directions.size();
  const int band = static_cast<int>(std::lround(2.5 / 0.5));
  std::vector<double> strongest(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    const float* row = rays.row(i);
    for (int k = 1; k + (ridge ? 7 : 2) < rays.count; ++k)
      strongest[i] = std::max(strongest[i], response(row, k, sign, ridge));
  }
  const double reference = quantile_of(strongest, 0.75);
  RayReading reading;
  reading.sign = sign;
  reading.ridge = ridge;
  if (!(reference > 0.0)) return reading;
  std::vector<double> radius(n, std::nan("")), inside, outside, gradient, found;
  for (std::size_t i = 0; i < n; ++i) {
    const float* row = rays.row(i);
    const int k = first_edge(row, rays.count, sign, ridge, reference);
    if (k < 0) continue;
    radius[i] = rays.position(k);
    found.push_back(radius[i]);
    gradient.push_back(response(row, k, sign, ridge));
    const float before = row[std::max(0, k - band)], after = row[std::min(rays.count - 1, k + band)];
    inside.push_back(ridge ? row[k] : before);
    if (!std::isnan(after)) outside.push_back(ridge ? 0.5 * (before + after) : after);
  }
  if (found.size() < n / 4 || outside.empty()) return reading;
  reading.inside = median_of(inside);
  reading.outside = median_of(outside);
  reading.median_radius = median_of(found);
  // A ray without an edge, or with one far from those of its neighbours, takes their median (7 nearest directions).
  std::vector<double> clean(n);
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<std::pair<double, std::size_t>> near;
    for (std::size_t j = 0; j < n; ++j) near.emplace_back(-directions[i].dot(directions[j]), j);
    std::partial_sort(near.begin(), near.begin() + 7, near.end());
    std::vector<double> values;
    for (std::size_t k = 0; k < 7; ++k) values.push_back(radius[near[k].second]);
    const double middle = median_of(values);
    clean[i] = std::clamp(std::isnan(middle) ? reading.median_radius : middle, 0.4 * reading.median_radius,
                          2.0 * reading.median_radius);
  }
  outline(directions, clean, seed.center, reading);
  const double seen = static_cast<double>(found.size()) / static_cast<double>(n);
  const double mean = sum(clean) / static_cast<double>(n);
  double variance = 0.0;
  for (const double r : clean) variance += (r - mean) * (r - mean) / static_cast<double>(n);
  const double mismatch = (ridge ? reading.outside - core : reading.inside - core) / (reading.inside - reading.outside);
  reading.score = seen * median_of(gradient) / (1.0 + 4.0 * mismatch * mismatch) / (1.0 + std::sqrt(variance) / mean);
  return reading;
}

}  // namespace

std::vector<RayReading> read_rays(const Image<float>& smoothed, const SeedSphere& seed, double h) {
  const std::vector<Vec3> directions = fibonacci_directions(kRays);
  const std::vector<Vec3> start(directions.size(), seed.center);
  const double length = std::min(smoothed.grid.extent().norm(), std::max(8.0 * seed.radius, 60.0 * h));
  Profiles rays = sample_profiles(TrilinearField(smoothed), start, directions, 0.0, length, 0.5 * h);
  smooth_along(rays);
  const double core = core_statistics(smoothed, {seed.center, std::max(0.5 * seed.radius, 1.5 * h)}, 1.0).median;
  return {read_one(rays, directions, seed, core, 1.0, false), read_one(rays, directions, seed, core, -1.0, false),
          read_one(rays, directions, seed, core, 1.0, true)};
}

CoreStatistics core_statistics(const Image<float>& image, const SeedSphere& seed, double fraction) {
  const double radius = std::max(fraction * seed.radius, 1.6 * image.grid.mean_spacing());
  std::vector<double> values;
  const Vec3 centre = image.grid.index_from_world(seed.center);
  Index3 lo{}, hi{};
  for (std::size_t a = 0; a < 3; ++a) {
    const int axis = static_cast<int>(a);
    const double reach = radius / image.grid.spacing[axis];
    lo[a] = std::clamp(static_cast<int>(std::ceil(centre[axis] - reach)), 0, image.grid.size[a] - 1);
    hi[a] = std::clamp(static_cast<int>(std::floor(centre[axis] + reach)), 0, image.grid.size[a] - 1);
  }
  for (int k = lo[2]; k <= hi[2]; ++k) {
    for (int j = lo[1]; j <= hi[1]; ++j) {
      for (int i = lo[0]; i <= hi[0]; ++i) {
        if ((image.grid.world_from_index(Vec3(i, j, k)) - seed.center).norm() <= radius)
          values.push_back(image.at(i, j, k));
      }
    }
  }
  if (values.empty()) {
    values.push_back(image.at(std::clamp(static_cast<int>(std::lround(centre[0])), 0, image.grid.size[0] - 1),
                              std::clamp(static_cast<int>(std::lround(centre[1])), 0, image.grid.size[1] - 1),
                              std::clamp(static_cast<int>(std::lround(centre[2])), 0, image.grid.size[2] - 1)));
  }
  return {median_of(values), robust_deviation(values), static_cast<int>(values.size())};
}

}  // namespace pellicle
