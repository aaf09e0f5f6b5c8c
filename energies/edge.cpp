#include "pellicle/energies/edge.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pellicle/base/parallel.h"

namespace pellicle {

namespace {
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// int_{-w}^{w} f ds - w by the trapezoid rule on the profile, ends interpolated.
double integral_position(const Profiles& p, std::size_t row, double inside, double outside, double window) {
  const float* values = p.row(row);
  const auto f_at = [&](double s) {
    const double k = (s - p.first) / p.step;
    const int low = std::clamp(static_cast<int>(std::floor(k + 1e-9)), 0, p.count - 2);
    const double part = k - low;
    const double v = (1.0 - part) * values[low] + part * values[low + 1];
    return std::clamp((v - outside) / (inside - outside), -0.5, 1.5);
  };
  const int first = static_cast<int>(std::ceil((-window - p.first) / p.step - 1e-9));
  const int last = static_cast<int>(std::floor((window - p.first) / p.step + 1e-9));
  double integral = 0.0, previous_s = -window, previous_f = f_at(-window);
  for (int k = first; k <= last + 1; ++k) {
    const double s = k <= last ? p.position(k) : window;
    const double f = f_at(s);
    integral += 0.5 * (previous_f + f) * (s - previous_s);
    previous_s = s;
    previous_f = f;
  }
  return integral - window;
}

// Centroid of the profile above a line between its two sides, about its highest point (for sign > 0).
double ridge_position(const Profiles& p, std::size_t row, double top, double inside, double outside, double window) {
  double moment = 0.0, mass = 0.0;
  for (int k = 0; k < p.count; ++k) {
    const double s = p.position(k);
    if (std::abs(s) > window + 1e-9) continue;
    const double side = inside + (outside - inside) * (s + window) / (2.0 * window);
    const double f = (p.row(row)[k] - side) / (top - 0.5 * (inside + outside));
    if (!(f > 0.25)) continue;
    mass += f - 0.25;
    moment += (f - 0.25) * s;
  }
  return mass > 0.0 ? moment / mass : kNaN;
}

// Width of the mean edge: the spread function is the derivative of the mean profile, aligned at the measured edges.
// It holds what trilinear interpolation adds too, which moves edges like any other blur.
double blur_of(const Profiles& p, const EdgeMeasurement& m, double h) {
  constexpr int kBins = 33;
  const double reach = 4.0 * h, width = 2.0 * reach / kBins;
  std::vector<double> total(kBins, 0.0), count(kBins, 0.0);
  for (std::size_t i = 0; i < m.targets.offset.size(); ++i) {
    if (!(m.targets.weight[i] > 0.0)) continue;
    for (int k = 0; k < p.count; ++k) {
      const double s = p.position(k) - m.targets.offset[i];
      const int bin = static_cast<int>(std::floor((s + reach) / width));
      if (bin < 0 || bin >= kBins || std::isnan(p.row(i)[k])) continue;
      const double f = (p.row(i)[k] - m.outside[i]) / (m.inside[i] - m.outside[i]);
      total[static_cast<std::size_t>(bin)] += f;
      count[static_cast<std::size_t>(bin)] += 1.0;
    }
  }
  // Second moment by parts: var = 2 int (F(s) - step(s)) s ds with F falling from 1 to 0.
  double moment = 0.0;
  for (int b = 0; b < kBins; ++b) {
    if (count[static_cast<std::size_t>(b)] == 0.0) return 0.0;
    const double s = -reach + (b + 0.5) * width;
    const double f = std::clamp(total[static_cast<std::size_t>(b)] / count[static_cast<std::size_t>(b)], 0.0, 1.0);
    if (std::abs(s) <= 3.0 * h) moment += 2.0 * (f - (s < 0 ? 1.0 : 0.0)) * s * width;
  }
  return std::sqrt(std::clamp(moment, 0.25 * h * h, 4.0 * h * h));
}

// Half of the ridge's width at half height, from the median profile over the surface, plus 1.5 h: wide enough for the
// flanks.
double ridge_window(const Profiles& p, double sign, double h) {
  const std::size_t n = p.values.size() / static_cast<std::size_t>(p.count);
  std::vector<double> typical(static_cast<std::size_t>(p.count));
  for (int k = 0; k < p.count; ++k) {
    std::vector<double> column;
    for (std::size_t i = 0; i < n; ++i) column.push_back(sign * p.row(i)[k]);
    typical[static_cast<std::size_t>(k)] = median_of(std::move(column));
  }
  const int origin = static_cast<int>(std::lround(-p.first / p.step));
  const double top = typical[static_cast<std::size_t>(origin)];
  const double half = 0.5 * (top + 0.5 * (typical.front() + typical.back()));
  int low = origin, high = origin;
  while (low > 0 && typical[static_cast<std::size_t>(low)] > half) --low;
  while (high + 1 < p.count && typical[static_cast<std::size_t>(high)] > half) ++high;
  return std::clamp(0.5 * (high - low) * p.step + 1.5 * h, 2.0 * h, 6.0 * h);
}

}  // namespace

NormalTargets ridge_search(const Profiles& profiles, double sign, double reach, double h) {
  const std::size_t n = profiles.values.size() / static_cast<std::size_t>(profiles.count);
  const int side = static_cast<int>(std::lround(3.0 * h / profiles.step));
  const auto height = [&](std::size_t i, int k) {
    const float* p = profiles.row(i);
    if (k < side || k + side >= profiles.count) return 0.0;
    const double v = std::min(sign * (p[k] - p[k - side]), sign * (p[k] - p[k + side]));
    return std::isnan(v) ? 0.0 : v;
  };
  std::vector<double> best(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    for (int k = 0; k < profiles.count; ++k) {
      if (std::abs(profiles.position(k)) <= reach) best[i] = std::max(best[i], height(i, k));
    }
  }
  const double typical = median_of(best);
  NormalTargets targets{std::vector<double>(n, 0.0), std::vector<double>(n, 0.05)};
  for (std::size_t i = 0; i < n; ++i) {
    double nearest = 2.0 * reach;
    for (int k = 1; k + 1 < profiles.count; ++k) {
      const double t = profiles.position(k), here = height(i, k);
      if (std::abs(t) > reach || std::abs(t) >= std::abs(nearest) || !(here >= 0.5 * typical) || !(here > 0.0))
        continue;
      if (here >= height(i, k - 1) && here >= height(i, k + 1)) nearest = t;
    }
    if (nearest <= reach) {
      targets.offset[i] = nearest;
      targets.weight[i] = 1.0;
    }
  }
  return targets;
}

EdgeMeasurement measure_edge(const Profiles& profiles, const SampleGraph& graph, const EdgeSettings& settings) {
  const std::size_t n = profiles.values.size() / static_cast<std::size_t>(profiles.count);
  const double h = settings.h;
  const double sign = settings.sign < 0 ? -1.0 : 1.0;
  const double window = settings.ridge ? ridge_window(profiles, sign, h) : settings.window * h;
  EdgeMeasurement m;
  m.targets = {std::vector<double>(n, 0.0), std::vector<double>(n, 0.0)};
  m.inside.resize(n);
  m.outside.resize(n);
  std::vector<double> near(settings.ridge ? n : 0);
  const double from = settings.ridge ? window : 2.0 * h, to = settings.ridge ? window + 2.0 * h : 4.0 * h;
  parallel_for(n, 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      m.inside[i] = band_median(profiles, i, -to, -from);
      m.outside[i] = band_median(profiles, i, from, to);
      if (settings.ridge) near[i] = band_median(profiles, i, -0.5 * h, 0.5 * h);
    }
  });
  average_over_mesh(graph, 6, m.inside);
  average_over_mesh(graph, 6, m.outside);
  average_over_mesh(graph, 2, near);
  std::vector<double> contrast(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double c = settings.ridge ? near[i] - 0.5 * (m.inside[i] + m.outside[i]) : m.inside[i] - m.outside[i];
    contrast[i] = settings.sign == 0 ? std::abs(c) : settings.sign * c;
  }
  m.median_contrast = median_of(contrast);
  if (!(m.median_contrast > 0.0)) return m;
  const int low = std::max(0, static_cast<int>(std::floor((-window - profiles.first) / profiles.step)));
  const int high = std::min(profiles.count - 1, static_cast<int>(std::ceil((window - profiles.first) / profiles.step)));
  parallel_for(n, 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      bool whole = true;
      for (int k = low; k <= high; ++k) whole = whole && !std::isnan(profiles.row(i)[k]);
      if (!whole || !(contrast[i] >= 0.25 * m.median_contrast)) continue;
      const double t = settings.ridge ? ridge_position(profiles, i, near[i], m.inside[i], m.outside[i], window)
                                      : integral_position(profiles, i, m.inside[i], m.outside[i], window);
      if (std::isnan(t)) continue;
      m.targets.offset[i] = t;
      m.targets.weight[i] = std::min(1.0, contrast[i] / m.median_contrast);
    }
  });
  if (!settings.ridge) m.blur = blur_of(profiles, m, h);
  return m;
}

std::vector<double> curvature_correction(const std::vector<double>& curvature, double blur, double h) {
  std::vector<double> correction;
  correction.reserve(curvature.size());
  for (const double k : curvature) correction.push_back(0.5 * blur * blur * std::clamp(k, -0.25 / h, 0.25 / h));
  return correction;
}

TermOutput EdgeTerm::operator()(const StepView& step) {
  const Reading& hypothesis = step.hypothesis;
  const double h = step.h, extent = (hypothesis.ridge ? 8.25 : 4.25) * h;
  constexpr double kWidest = 2.5, kNarrowest = 1.75;  // h
  const double first = step.continued ? kNarrowest : kWidest;
  window = std::max(kNarrowest, step.step == 0 ? first : std::pow(0.9, 1.0 / step.delay) * window);
  const Profiles profiles = sample_profiles(TrilinearField(*step.image), step.surface, extent, extent, 0.25 * h);
  EdgeMeasurement m =
      measure_edge(profiles, *step.surface.graph, {h, window, hypothesis.ridge, hypothesis.sign > 0.0 ? 1 : -1});
  TermOutput out;
  double blur = step.blur_mm;
  if (step.step < 2.0 * step.delay) {
    curvature = sum_of_curvatures(step.surface);
    average_over_mesh(*step.surface.graph, 8, curvature);
    blur = m.blur > 0.0 ? m.blur : 1.1 * h;
    out.found.blur_mm = blur;
  }
  m.targets.correction = curvature_correction(curvature, blur, h);
  if (m.median_contrast > 0.0 && !hypothesis.similarity) {
    out.found.levels = step.levels;
    out.found.levels->inside = median_of(m.inside);
    out.found.levels->outside = median_of(m.outside);
  }
  out.found.searching = !step.continued && step.step < 3;
  out.pull = std::move(m.targets);
  return out;
}

}  // namespace pellicle
