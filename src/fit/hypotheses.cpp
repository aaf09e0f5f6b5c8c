#include "pellicle/fit/hypotheses.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pellicle/energies/energy_kinds.h"
#include "pellicle/energies/profiles.h"
#include "pellicle/fit/expert_points.h"
#include "pellicle/seed/head.h"
#include "pellicle/seed/rays.h"

namespace pellicle {

namespace {

Candidate candidate_from(const SurfaceModel& model, const Vec3& centre, const Mat3& shape) {
  Candidate state{.surface = {model, on_ellipsoid(model, centre, shape)}};
  state.start_volume = 4.0 / 3.0 * std::numbers::pi * std::abs(shape.determinant());
  return state;
}

// Hypotheses are compared after the region stages of the first two levels of detail: far enough to tell a leak from an
// object, cheap enough to do for each.
std::size_t comparison_point(const std::vector<Stage>& stages) {
  std::size_t at = 0;
  while (at < stages.size() && at < 2 && stages[at].energies.with(&EnergyTraits::localises) == nullptr) ++at;
  return std::max<std::size_t>(1, at);
}

bool allowed(const FitSettings& settings, const RayReading& reading) {
  if (reading.score <= 0.0) return false;
  if (settings.boundary == Boundary::ridge) return reading.ridge;
  if (reading.ridge) return settings.boundary == Boundary::automatic && settings.polarity != Polarity::dark;
  if (settings.polarity == Polarity::bright) return reading.sign > 0.0;
  if (settings.polarity == Polarity::dark) return reading.sign < 0.0;
  return true;
}

// The image around a seed at a scale that rays can afford: about an eighth of the seed's radius, at most 2 million
// voxels.
Image<float> ray_image(const Image<float>& image, const SeedSphere& seed, double& h) {
  const double h_in = image.grid.mean_spacing();
  const double length = std::max(8.0 * seed.radius, 60.0 * h_in);
  const Vec3 reach = Vec3::Constant(length);
  const IndexBox box = box_around(image.grid, seed.center - reach, seed.center + reach, 4.0 * h_in);
  double voxels = 1.0;
  for (const int s : box.size) voxels *= s;
  double spacing = std::max(h_in, seed.radius / 8.0);
  spacing = std::max(spacing, h_in * std::cbrt(voxels / 2e6));
  const Image<float> coarse = crop_and_bin(image, box, bin_factors(image.grid, spacing));
  h = coarse.grid.mean_spacing();
  return gaussian_smooth(coarse, h);
}

std::string reading_name(const RayReading& reading) {
  return reading.ridge ? "membrane" : reading.sign > 0.0 ? "bright" : "dark";
}

std::vector<Candidate> sphere_hypotheses(const Image<float>& image, const SeedSphere& seed, const FitSettings& settings,
                                         const std::string& prefix) {
  std::vector<Candidate> list;
  double h = 1.0;
  const Image<float> smoothed = ray_image(image, seed, h);
  const SurfaceModel model = start_model(settings.model);
  std::vector<RayReading> readings = read_rays(smoothed, seed, h);
  std::stable_sort(readings.begin(), readings.end(), [](const auto& a, const auto& b) { return a.score > b.score; });
  for (const RayReading& rays : readings) {
    if (!allowed(settings, rays)) continue;
    const bool as_seeded = settings.start_rule == StartRule::sphere;
    const Mat3 ball = seed.radius * Mat3::Identity();
    Candidate hypothesis =
        as_seeded ? candidate_from(model, seed.center, ball) : candidate_from(model, rays.center, rays.shape);
    hypothesis.stages = stages_of(settings);
    hypothesis.reading = {prefix + reading_name(rays), rays.sign, rays.ridge, rays.inside, rays.outside, {}, {}};
    hypothesis.levels = {rays.inside, rays.outside, {}, {}};
    const double radius = std::cbrt(std::abs(rays.shape.determinant()));
    if (!as_seeded) hypothesis.first_reach_mm = std::max(0.6 * radius, 5.0 * h);
    hypothesis.compare_after = comparison_point(hypothesis.stages);
    hypothesis.ball = seed;
    hypothesis.seed_radius = std::max(seed.radius, 4.0 * h);  // a click says little of the size
    list.push_back(std::move(hypothesis));
  }
  return list;
}

Candidate head_hypothesis(const Image<float>& image, const SeedSphere& seed, const FitSettings& settings,
                          const std::string& prefix) {
  const HeadReading head = read_head(image);
  Candidate hypothesis = candidate_from(start_model(settings.model), seed.center, seed.radius * Mat3::Identity());
  hypothesis.stages = stages_of(settings);
  hypothesis.certain = true;
  hypothesis.reading.name = prefix + "head";
  hypothesis.reading.tissue = head.levels;
  hypothesis.reading.inside = hypothesis.levels.inside = head.levels.middle;
  hypothesis.reading.outside = hypothesis.levels.outside = head.levels.low;
  hypothesis.compare_after = hypothesis.stages.size();
  return hypothesis;
}

// Levels and polarity as a surface tells them, from bands of its profiles between the given depths (mm, inside) and
// heights (outside).
struct Bands {
  double inside_near, inside_far, outside_near, outside_far;
};

void read_levels(const Image<float>& image, const FitSettings& settings, const SurfaceSamples& samples,
                 const Bands& bands, Candidate& state) {
  const double h = image.grid.mean_spacing();
  const double reach = std::max(bands.inside_far, bands.outside_far);
  const Reading plain;
  WorkingImage working(image, plain, 1.0, h, reach + h);
  working.cover(samples.x);
  const Profiles profiles = sample_profiles(TrilinearField(working.image()), samples.x, samples.normal, reach, reach,
                                            std::max(0.5 * h, reach / 40.0));
  std::vector<double> in, out, top;
  for (std::size_t i = 0; i < samples.x.size(); ++i) {
    in.push_back(band_median(profiles, i, -bands.inside_far, -bands.inside_near));
    out.push_back(band_median(profiles, i, bands.outside_near, bands.outside_far));
    top.push_back(band_median(profiles, i, -0.5 * h, 0.5 * h));
  }
  state.reading.ridge = settings.boundary == Boundary::ridge;
  state.reading.inside = median_of(state.reading.ridge ? top : in);
  state.reading.outside = median_of(out);
  state.reading.sign = state.reading.inside >= state.reading.outside ? 1.0 : -1.0;
  if (settings.polarity != Polarity::automatic) state.reading.sign = settings.polarity == Polarity::bright ? 1.0 : -1.0;
  state.levels = {state.reading.inside, state.reading.outside, {}, {}};
}

// A surface that is already near tells its levels and its polarity itself, and is refined by edge stages alone: the
// wide searches that find an object from a ball would only lead away from it. Should it be off by more than edge
// stages reach, a search over half of the object's thickness (2 V/A: the radius of a tube) is the second reading.
std::vector<Candidate> surface_hypotheses(const Image<float>& image, const Surface& seed, const FitSettings& settings,
                                          const std::string& prefix) {
  GeometryCache geometry;
  const StageGeometry& g = geometry.get(seed.model, sampling_level(seed.model, 1e9, 1.0, Density::fine));
  SurfaceSamples samples;
  evaluate(seed.model, seed.parameters, g.layout, false, samples);
  const double volume = facet_volume(g.layout, samples.x);
  const double thickness = 2.0 * volume / sum(sample_areas(g.layout, samples.x)), h = image.grid.mean_spacing();
  const auto reading = [&](const std::string& name, const Bands& bands) {
    Candidate hypothesis{.surface = seed, .stages = stages_of(settings)};
    hypothesis.detail = refinements_of(seed.model);
    hypothesis.start_volume = volume;
    hypothesis.reading.name = prefix + name;
    read_levels(image, settings, samples, bands, hypothesis);
    return hypothesis;
  };
  constexpr double kNear = 3.0;  // voxels
  const auto searches = [](const Stage& stage) { return stage.energies.with(&EnergyTraits::searches) != nullptr; };
  std::vector<Candidate> list;
  list.push_back(reading("seed surface", {1.5 * h, 5.0 * h, 1.5 * h, 5.0 * h}));
  Candidate& near = list.front();
  if (settings.start_rule == StartRule::head) near.reading.tissue = read_head(image).levels;
  if (!settings.stages.empty() || settings.start_rule == StartRule::head) {
    near.certain = true;
    near.compare_after = near.stages.size();
    return list;
  }
  near.limit = std::make_shared<const SearchLimit>(mesh_of(g.layout, samples), kNear * h);
  std::erase_if(near.stages, searches);
  near.stages.insert(near.stages.begin(), near.stages.front());  // compared first, then run again with samples left out
  near.compare_after = 1;
  if (near.reading.ridge || !(thickness > 0.0)) {
    near.certain = true;
    return list;
  }
  list.push_back(
      reading("seed surface, searched around", {0.25 * thickness, 0.7 * thickness, 0.4 * thickness, thickness}));
  list.back().first_reach_mm = std::max(0.5 * thickness, 5.0 * h);
  list.back().compare_after = comparison_point(list.back().stages);
  return list;
}

}  // namespace

std::vector<Candidate> hypotheses_for(const Image<float>& image, const Seed& seed, const FitSettings& settings,
                                      const std::string& prefix, const Observer& observer) {
  const auto* surface = std::get_if<Surface>(&seed);
  const bool free_start = settings.start_rule == StartRule::automatic && settings.stages.empty();
  if (free_start && stages_of(settings).front().energies.uses(&EnergyTraits::needs_points)) {
    const double h = image.grid.mean_spacing();
    const std::optional<Surface> start =
        surface != nullptr ? std::optional(*surface) : ellipsoid_of(settings.points, settings.model, h);
    if (start) {
      const Surface drawn = drawn_to_points(image, *start, settings.points, settings.detail.value_or(2), observer);
      std::vector<Candidate> list = surface_hypotheses(image, drawn, settings, prefix + "expert points, ");
      // The points say where the object is: no wider search, and no other reading unless this one fails.
      list.erase(list.begin() + 1, list.end());
      list.front().certain = true;
      list.front().limit = search_limit_of(drawn, settings.points, h);
      return list;
    }
  }
  if (surface != nullptr) return surface_hypotheses(image, *surface, settings, prefix);
  const auto& sphere = std::get<SeedSphere>(seed);
  if (settings.start_rule == StartRule::head) return {head_hypothesis(image, sphere, settings, prefix)};
  return sphere_hypotheses(image, sphere, settings, prefix);
}

std::vector<Candidate> similarity_hypotheses(const Image<float>& image, const SeedSphere& seed,
                                             const FitSettings& settings, const std::string& prefix) {
  const double h = image.grid.mean_spacing();
  const double around = std::max(4.0 * seed.radius, 15.0 * h);
  const Vec3 reach = Vec3::Constant(around);
  const IndexBox box = box_around(image.grid, seed.center - reach, seed.center + reach, 0.0);
  const Image<float> smoothed = gaussian_smooth(crop_and_bin(image, box, {1, 1, 1}), 0.7 * h);
  const double level = core_statistics(smoothed, seed, 0.6).median;
  // Never finer than half a percent of the range: without noise any structure would be told from any other.
  std::vector<double> values(smoothed.voxels.begin(), smoothed.voxels.end());
  const double range_around = quantile_of(values, 0.98) - quantile_of(values, 0.02);
  const double noise = std::max(noise_of(image, box), 0.005 * range_around);
  std::vector<Candidate> list;
  if (!(noise > 0.0)) return list;
  for (int j = 0; j <= 8; ++j) {
    const double range = 1.5 * noise * std::pow(2.0, 0.5 * j);
    Candidate hypothesis = candidate_from(start_model(settings.model), seed.center, seed.radius * Mat3::Identity());
    hypothesis.reading = {fmt::format("{}alike {:.4g} +- {:.4g}", prefix, level, range),
                          1.0,
                          false,
                          0.0,
                          -range,
                          Similarity{level, range},
                          {}};
    hypothesis.levels = {0.0, -range, {}, {}};
    hypothesis.start_volume = 0.0;  // the seed says where, not how large: evidence judges
    hypothesis.ball = seed;
    hypothesis.seed_radius = std::max(seed.radius, 4.0 * h);  // a click says little of the size
    const double smooth = 1e-3;
    hypothesis.stages = {{.name = "coarse",
                          .detail = 1,
                          .energies = {{energy::region, 1.0}, {energy::bending, smooth}, {energy::spacing, 0.05}},
                          .reach = 5.0},
                         {.name = "region",
                          .detail = 2,
                          .energies = {{energy::region, 1.0}, {energy::bending, smooth}, {energy::spacing, 0.05}},
                          .reach = 5.0,
                          .max_steps = 8},
                         {.name = "edge",
                          .detail = 2,
                          .energies = {{energy::edge, 1.0}, {energy::bending, smooth}, {energy::spacing, 0.05}},
                          .smoothing = 0.0,
                          .max_steps = 6,
                          .tolerance = 0.01}};
    hypothesis.compare_after = hypothesis.stages.size();
    // The chosen range goes on as other readings do: samples are left out, and more control points are kept only if
    // they foretell these better.
    const Stage edge = hypothesis.stages.back();
    hypothesis.stages.push_back(edge);
    hypothesis.stages.push_back(edge);
    hypothesis.stages.back().name = "edge fine";
    hypothesis.stages.back().detail = 3;
    for (Stage& stage : hypothesis.stages) stage.resolution = 1.0;
    hypothesis.stages = with_settings(std::move(hypothesis.stages), settings);
    list.push_back(std::move(hypothesis));
  }
  return list;
}

}  // namespace pellicle
