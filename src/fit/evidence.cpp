#include "pellicle/fit/evidence.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pellicle/energies/profiles.h"
#include "pellicle/energies/reading.h"

namespace pellicle {

namespace {

struct InsideStatistics {
  double median = 0.0, deviation = 0.0;
};

// Median and spread of the image within the surface, at six depths below each sample: equal shares of the volume in a
// ball; in any other body, tori included, depths are measured against its thickness 3 V/A (a ball's radius), and the
// deepest, 0.56 of it, is still inside a tube.
InsideStatistics inside_of(const TrilinearField& image, const SurfaceSamples& samples, double thickness) {
  std::vector<double> values;
  values.reserve(6 * samples.x.size());
  for (int shell = 0; shell < 6; ++shell) {
    const double depth = thickness * (1.0 - std::cbrt((shell + 0.5) / 6.0));
    for (std::size_t i = 0; i < samples.x.size(); ++i) {
      values.push_back(static_cast<double>(image.at(samples.x[i] - depth * samples.normal[i])));
    }
  }
  const double deviation = robust_deviation(values);
  return {median_of(std::move(values)), deviation};
}

}  // namespace

Evidence evidence_of(const Image<float>& image, const Surface& surface, bool ridge, GeometryCache& geometry) {
  Evidence e;
  const StageGeometry& coarse = geometry.get(surface.model, sampling_level(surface.model, 1e9, 1.0, Density::fine));
  SurfaceSamples samples;
  evaluate(surface.model, surface.parameters, coarse.layout, false, samples);
  const std::vector<double> area = sample_areas(coarse.layout, samples.x);
  const double total = sum(area);
  const double h_in = image.grid.mean_spacing();
  const double resolution = std::max(1.0, std::sqrt(total / (4.0 * std::numbers::pi)) / (20.0 * h_in));
  const Reading plain;
  const double h = WorkingImage(image, plain, resolution, 0.0, 0.0).h();
  WorkingImage working(image, plain, resolution, 0.7 * h, 9.0 * h);
  working.cover(samples.x);
  const Profiles profiles =
      sample_profiles(TrilinearField(working.image()), samples.x, samples.normal, 5.0 * h, 8.0 * h, 0.5 * h);
  const double thickness = 3.0 * facet_volume(coarse.layout, samples.x) / total;
  const InsideStatistics inside = inside_of(TrilinearField(working.image()), samples, std::max(0.0, thickness));
  e.noise = noise_of(working.image(), {{0, 0, 0}, working.image().grid.size});
  std::vector<double> away, contrast;
  std::size_t returning = 0;
  for (std::size_t i = 0; i < area.size(); ++i) {
    const double near = ridge ? 2.5 * h : 1.5 * h, far = ridge ? 5.0 * h : 4.0 * h;
    const double in = band_median(profiles, i, -far, -near), out = band_median(profiles, i, near, far);
    if (!image.grid.contains(samples.x[i]) || std::isnan(in) || std::isnan(out)) {
      e.outside_share += area[i] / total;
      continue;
    }
    if (ridge) {
      const double top = band_median(profiles, i, -0.5 * h, 0.5 * h);
      away.push_back(top - std::max(in, out));
      contrast.push_back(top - 0.5 * (in + out));
    } else {
      away.push_back(std::abs(out - inside.median) - std::abs(in - inside.median));
      contrast.push_back(std::abs(in - out));
      const double beyond = band_median(profiles, i, 4.5 * h, 8.0 * h);
      returning += std::abs(beyond - in) < 0.5 * std::abs(out - in) ? 1 : 0;
    }
  }
  if (away.empty()) return e;
  e.contrast = median_of(contrast);
  std::size_t weak = 0;
  for (const double c : contrast) weak += c < 0.25 * e.contrast ? 1 : 0;
  e.weak_share = static_cast<double>(weak) / static_cast<double>(contrast.size());
  e.returning_share = static_cast<double>(returning) / static_cast<double>(contrast.size());
  // A fiftieth of the range stands in for noise where there is none.
  std::vector<double> values(working.image().voxels.begin(), working.image().voxels.end());
  const double range = quantile_of(values, 0.98) - quantile_of(values, 0.02);
  const double spread = inside.deviation + 0.5 * e.noise + 0.02 * range;
  const double lower = quantile_of(away, 0.25);
  e.score = spread > 0.0 ? lower / spread * (1.0 - e.outside_share) : 0.0;
  e.score = std::isfinite(e.score) ? std::clamp(e.score, -1e3, 1e3) : -1e3;
  return e;
}

}  // namespace pellicle
