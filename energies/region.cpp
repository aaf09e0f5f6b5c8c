#include "pellicle/energies/region.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pellicle/base/parallel.h"
#include "pellicle/energies/edge.h"

namespace pellicle {

namespace {
constexpr double kPull = 0.02;  // of the distance travelled: decides between equal minima for the nearer one

// argmin over the profile of the cumulated potential, refined to the zero of the potential beside it.
double best_position(const Profiles& p, std::size_t row, double inside, double outside, double reach, double depth) {
  const double half = 0.5 * (inside - outside), middle = 0.5 * (inside + outside);
  const auto potential = [&](int k) {
    const float v = p.row(row)[k];
    return std::isnan(v) ? std::numeric_limits<double>::quiet_NaN() : std::clamp((middle - v) / half, -1.0, 1.0);
  };
  const int origin = static_cast<int>(std::lround(-p.first / p.step));
  double best = 0.0, best_cost = 0.0;
  for (const int direction : {1, -1}) {
    double cost = 0.0, last = potential(origin);
    if (std::isnan(last)) return 0.0;
    for (int k = origin + direction; k >= 0 && k < p.count; k += direction) {
      const double t = p.position(k);
      if (t > reach + 1e-9 || -t > depth + 1e-9) break;
      const double q = potential(k);
      if (std::isnan(q)) break;
      // The minimum between two samples lies where q, linear in between, passes zero upward (seen outward).
      const double inner = direction > 0 ? last : q, outer = direction > 0 ? q : last;
      if (inner < 0.0 && outer >= 0.0) {
        const double part = direction > 0 ? inner / (inner - outer) : outer / (outer - inner);
        const double at = p.position(k - direction) + direction * part * p.step;
        const double partial = cost + direction * 0.5 * last * part * p.step + kPull * at * at / reach;
        if (partial < best_cost) {
          best_cost = partial;
          best = at;
        }
      }
      cost += direction * 0.5 * (last + q) * p.step;
      const double whole = cost + kPull * t * t / reach;
      if (whole < best_cost) {
        best_cost = whole;
        best = t;
      }
      last = q;
    }
  }
  return best;
}

}  // namespace

NormalTargets region_targets(const Profiles& profiles, const Levels& levels, double reach, double depth) {
  const std::size_t n = profiles.values.size() / static_cast<std::size_t>(profiles.count);
  NormalTargets targets{std::vector<double>(n, 0.0), std::vector<double>(n, 1.0)};
  const bool local = !levels.local_inside.empty();
  const int origin = static_cast<int>(std::lround(-profiles.first / profiles.step));
  parallel_for(n, 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (std::isnan(profiles.row(i)[origin])) {
        targets.weight[i] = 0.0;  // outside the image: no evidence, smoothness decides
        continue;
      }
      targets.offset[i] =
          best_position(profiles, i, local ? levels.local_inside[i] : levels.inside,
                        local ? levels.local_outside[i] : levels.outside, reach, std::min(reach, depth));
    }
  });
  return targets;
}

bool update_levels(const Profiles& profiles, const NormalTargets& targets, const SampleGraph& graph, double h,
                   bool local, double first_contrast, Levels& levels) {
  const std::size_t n = targets.offset.size();
  std::vector<double> inside(n), outside(n);
  parallel_for(n, 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const double t = targets.offset[i];
      inside[i] = band_median(profiles, i, t - 6.0 * h, t - 1.5 * h);
      outside[i] = band_median(profiles, i, t + 1.5 * h, t + 5.0 * h);
      if (!(targets.weight[i] > 0.0)) inside[i] = outside[i] = std::numeric_limits<double>::quiet_NaN();
    }
  });
  const double a = 0.5 * (levels.inside + median_of(inside)), b = 0.5 * (levels.outside + median_of(outside));
  if (!((a - b) / first_contrast >= 0.3)) return false;
  levels.inside = a;
  levels.outside = b;
  if (!local) return true;
  // A band of a few voxels is shrunk towards the global level with the weight of two more, then neighbours agree.
  constexpr double kBandPoints = 4.0, kPriorPoints = 2.0;
  const auto shrink = [&](std::vector<double>& level, double global) {
    for (double& v : level) {
      if (!std::isnan(v)) v = (kBandPoints * v + kPriorPoints * global) / (kBandPoints + kPriorPoints);
    }
    average_over_mesh(graph, 4, level);
    for (double& v : level) {
      if (std::isnan(v)) v = global;
    }
  };
  shrink(inside, a);
  shrink(outside, b);
  const double floor = 0.4 * (a - b);
  for (std::size_t i = 0; i < n; ++i) {
    if (!((inside[i] - outside[i]) / floor >= 1.0)) {
      const double middle = 0.5 * (inside[i] + outside[i]);
      inside[i] = middle + 0.5 * floor;
      outside[i] = middle - 0.5 * floor;
    }
  }
  levels.local_inside = std::move(inside);
  levels.local_outside = std::move(outside);
  return true;
}

Image<float> region_potential(const Image<float>& image, double inside, double outside) {
  Image<float> q = image;
  const double half = 0.5 * (inside - outside), middle = 0.5 * (inside + outside);
  for (float& v : q.voxels) v = static_cast<float>(std::clamp((middle - v) / half, -1.0, 1.0));
  return q;
}

Image<float> antiderivative(const Image<float>& image) {
  Image<float> out(image.grid);
  const Index3& size = image.grid.size;
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      double sum = 0.0;
      for (int i = 1; i < size[0]; ++i) {
        sum += 0.5 * image.grid.spacing[0] * (image.at(i - 1, j, k) + image.at(i, j, k));
        out.at(i, j, k) = static_cast<float>(sum);
      }
    }
  }
  return out;
}

double region_integral(const CubicField& antiderivative, const Vec3& axis_in_world, double scale,
                       const std::vector<Vec3>& x, const std::vector<Vec3>& area_vector, std::vector<Vec3>& dE_dx,
                       std::vector<Vec3>& dE_da) {
  std::vector<double> part(x.size());
  parallel_for(x.size(), 128, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Vec3 gradient;
      const double value = antiderivative.value(x[i], gradient);
      const double along = axis_in_world.dot(area_vector[i]);
      part[i] = value * along;
      dE_dx[i] += scale * along * gradient;
      dE_da[i] += scale * value * axis_in_world;
    }
  });
  double energy = 0.0;
  for (const double p : part) energy += p;
  return scale * energy;
}

void estimate_levels(const StepView& step, Levels& levels) {
  const double h = step.h;
  const Profiles profiles = sample_profiles(TrilinearField(*step.image), step.surface, 6.5 * h, 6.5 * h, 0.5 * h);
  const NormalTargets here{std::vector<double>(step.surface.size(), 0.0),
                           std::vector<double>(step.surface.size(), 1.0)};
  update_levels(profiles, here, *step.surface.graph, h, false, step.first_contrast, levels);
}

namespace {

// R <- max(4 h, min(0.85 R, 4 p90|t| + 3 h)): wide at first, narrow once the surface has arrived. A surface that
// follows slowly narrows it slowly.
double narrowed(double reach, const NormalTargets& targets, const StepView& step) {
  std::vector<double> size;
  for (const double t : targets.offset) size.push_back(std::abs(t));
  const double h = step.h;
  return std::max(4.0 * h, std::min(std::pow(0.85, 1.0 / step.delay) * reach, 4.0 * quantile_of(size, 0.9) + 3.0 * h));
}

}  // namespace

TermOutput RegionTerm::operator()(const StepView& step) {
  if (step.step == 0) reach = step.reach_mm;
  const double h = step.h, extent = reach + 6.5 * h;
  const double spacing = reach > 10.0 * h ? reach / 20.0 : 0.5 * h;
  const Profiles profiles = sample_profiles(TrilinearField(*step.image), step.surface, extent, extent, spacing);
  // Not past the middle, which would turn the surface inside out: 2 V/A is the radius of a tube, two thirds of a
  // ball's.
  const double depth = 2.0 * step.surface.volume / step.surface.total_area;
  const Reading& hypothesis = step.hypothesis;
  NormalTargets targets = hypothesis.ridge ? ridge_search(profiles, hypothesis.sign, reach, h)
                                           : region_targets(profiles, step.levels, reach, depth);
  TermOutput out;
  if (!hypothesis.similarity && !hypothesis.ridge) {
    out.found.levels = step.levels;
    update_levels(profiles, targets, *step.surface.graph, h, step.step > 0, step.first_contrast, *out.found.levels);
  }
  reach = narrowed(reach, targets, step);
  out.found.searching = reach > 6.0 * h;
  out.pull = std::move(targets);
  return out;
}

TermOutput RegionIntegralTerm::operator()(const StepView& step) {
  if (!image || version != step.image_version || inside != step.levels.inside || outside != step.levels.outside) {
    version = step.image_version;
    inside = step.levels.inside;
    outside = step.levels.outside;
    image = std::make_shared<const Image<float>>(antiderivative(region_potential(*step.image, inside, outside)));
  }
  const double scale = step.weight * step.h / step.surface.total_area;
  const Vec3 axis = step.image->grid.direction.col(0);
  return {[kept = image, scale, axis](const auto& x, const auto& area, auto& dx, auto& da) {
    return region_integral(CubicField(*kept), axis, scale, x, area, dx, da);
  }};
}

}  // namespace pellicle
