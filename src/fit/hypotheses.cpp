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

bool allowed(const FitOptions& options, const RayReading& reading) {
  if (reading.score <= 0.0) return false;
  if (options.boundary == Boundary::ridge) return reading.ridge;
  if (reading.ridge) return options.boundary == Boundary::automatic && options.polarity != Polarity::dark;
  if (options.polarity == Polarity::bright) return reading.sign > 0.0;
  if (options.polarity == Polarity::dark) return reading.sign < 0.0;
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

/// What all hypotheses about one seed have in common.
struct Common {
  const Image<float>& image;
  const FitOptions& options;
  const FitPlan& plan;
  const std::string& prefix;  ///< of their names
};

std::vector<Candidate> ball_hypotheses(const Common& common, const SeedSphere& seed) {
  std::vector<Candidate> list;
  double h = 1.0;
  const Image<float> smoothed = ray_image(common.image, seed, h);
  const SurfaceModel model = start_model(common.options.model);
  std::vector<RayReading> readings = read_rays(smoothed, seed, h);
  std::stable_sort(readings.begin(), readings.end(), [](const auto& a, const auto& b) { return a.score > b.score; });
  for (const RayReading& rays : readings) {
    if (!allowed(common.options, rays)) continue;
    const bool as_seeded = common.options.start_rule == StartRule::sphere;
    const Mat3 ball = seed.radius * Mat3::Identity();
    Candidate hypothesis =
        as_seeded ? candidate_from(model, seed.center, ball) : candidate_from(model, rays.center, rays.shape);
    hypothesis.line = common.plan.first;
    hypothesis.reading = {common.prefix + reading_name(rays), rays.sign, rays.ridge, rays.inside, rays.outside, {}, {}};
    hypothesis.levels = {rays.inside, rays.outside, {}, {}};
    const double radius = std::cbrt(std::abs(rays.shape.determinant()));
    if (!as_seeded) hypothesis.first_reach_mm = std::max(0.6 * radius, 5.0 * h);
    hypothesis.ball = seed;
    hypothesis.seed_radius = std::max(seed.radius, 4.0 * h);  // a click says little of the size
    list.push_back(std::move(hypothesis));
  }
  return list;
}

Candidate head_hypothesis(const Common& common, const SeedSphere& seed) {
  const HeadReading head = read_head(common.image);
  Candidate hypothesis = candidate_from(start_model(common.options.model), seed.center, seed.radius * Mat3::Identity());
  hypothesis.line = common.plan.first;
  hypothesis.certain = common.plan.certain;
  hypothesis.reading.name = common.prefix + "head";
  hypothesis.reading.tissue = head.levels;
  hypothesis.reading.inside = hypothesis.levels.inside = head.levels.middle;
  hypothesis.reading.outside = hypothesis.levels.outside = head.levels.low;
  return hypothesis;
}

/// Where intensities are measured along the normals of a surface: between these depths inside it and these heights
/// outside, mm.
struct Bands {
  double inside_near, inside_far, outside_near, outside_far;
};

void read_levels(const Image<float>& image, const FitOptions& settings, const SurfaceSamples& samples,
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

// A surface that is near the object is measured for intensities and polarity, and refined. Should it be off by more
// than edge stages reach, a search over half of the object's thickness (2 V/A: the radius of a tube) is the second
// hypothesis.
std::vector<Candidate> surface_hypotheses(const Common& common, const Surface& seed) {
  GeometryCache geometry;
  const StageGeometry& g = geometry.get(seed.model, sampling_level(seed.model, 1e9, 1.0, Density::fine));
  SurfaceSamples samples;
  evaluate(seed.model, seed.parameters, g.layout, false, samples);
  const double volume = facet_volume(g.layout, samples.x);
  const double thickness = 2.0 * volume / sum(sample_areas(g.layout, samples.x));
  const double h = common.image.grid.mean_spacing();
  const auto hypothesis_of = [&](const std::string& name, const PlanLine& line, const Bands& bands) {
    Candidate hypothesis{.surface = seed};
    hypothesis.line = line;
    hypothesis.detail = refinements_of(seed.model);
    hypothesis.start_volume = volume;
    hypothesis.reading.name = common.prefix + name;
    read_levels(common.image, common.options, samples, bands, hypothesis);
    return hypothesis;
  };
  constexpr double kNear = 3.0;  // voxels
  std::vector<Candidate> list;
  list.push_back(hypothesis_of("seed surface", common.plan.first, {1.5 * h, 5.0 * h, 1.5 * h, 5.0 * h}));
  Candidate& near = list.front();
  near.certain = common.plan.certain || !(thickness > 0.0);
  if (common.options.start_rule == StartRule::head) near.reading.tissue = read_head(common.image).levels;
  if (common.plan.near) near.limit = std::make_shared<const SearchLimit>(mesh_of(g.layout, samples), kNear * h);
  if (near.certain || !common.plan.around) return list;
  list.push_back(hypothesis_of("seed surface, searched around", *common.plan.around,
                               {0.25 * thickness, 0.7 * thickness, 0.4 * thickness, thickness}));
  list.back().first_reach_mm = std::max(0.5 * thickness, 5.0 * h);
  return list;
}

// The surface that expert points outline, where the fit may start at it.
std::optional<Surface> outlined_start(const Image<float>& image, const Seed& seed, const FitOptions& options,
                                      const ExpertPoints& points) {
  if (points.points.empty() || !may_start_at_points(options)) return std::nullopt;
  if (const auto* surface = std::get_if<Surface>(&seed)) return *surface;
  return ellipsoid_of(points, options.model, image.grid.mean_spacing());
}

}  // namespace

std::vector<Candidate> hypotheses_for(const Image<float>& image, const Seed& seed, const FitOptions& options,
                                      const ExpertPoints& points, const std::string& prefix, const Observer& observer) {
  const bool with_points = !points.points.empty();
  if (const std::optional<Surface> start = outlined_start(image, seed, options, points)) {
    const FitPlan plan = plan_for(options, StartKind::outlined, with_points);
    const Surface drawn = drawn_to_points(image, *start, points, plan.outline, observer);
    const std::string name = prefix + "expert points, ";
    std::vector<Candidate> list = surface_hypotheses({image, options, plan, name}, drawn);
    list.front().limit = search_limit_of(drawn, points, image.grid.mean_spacing());
    return list;
  }
  const auto* surface = std::get_if<Surface>(&seed);
  const FitPlan plan = plan_for(options, surface != nullptr ? StartKind::surface : StartKind::ball, with_points);
  const Common common{image, options, plan, prefix};
  if (surface != nullptr) return surface_hypotheses(common, *surface);
  const auto& ball = std::get<SeedSphere>(seed);
  if (options.start_rule == StartRule::head) return {head_hypothesis(common, ball)};
  return ball_hypotheses(common, ball);
}

std::vector<Candidate> similarity_hypotheses(const Image<float>& image, const SeedSphere& seed,
                                             const FitOptions& options, const PlanLine& line,
                                             const std::string& prefix) {
  const double h = image.grid.mean_spacing();
  const double around = std::max(4.0 * seed.radius, 15.0 * h);
  const Vec3 reach = Vec3::Constant(around);
  const IndexBox box = box_around(image.grid, seed.center - reach, seed.center + reach, 0.0);
  const Image<float> smoothed = gaussian_smooth(crop_and_bin(image, box, {1, 1, 1}), 0.7 * h);
  const double level = core_statistics(smoothed, seed, 0.6).median;
  // Never finer than half a percent of the range: without noise the smallest differences would count.
  std::vector<double> values(smoothed.voxels.begin(), smoothed.voxels.end());
  const double range_around = quantile_of(values, 0.98) - quantile_of(values, 0.02);
  const double noise = std::max(noise_of(image, box), 0.005 * range_around);
  std::vector<Candidate> list;
  if (!(noise > 0.0)) return list;
  for (int j = 0; j <= 8; ++j) {
    const double range = 1.5 * noise * std::pow(2.0, 0.5 * j);
    Candidate hypothesis = candidate_from(start_model(options.model), seed.center, seed.radius * Mat3::Identity());
    hypothesis.reading = {fmt::format("{}similar to {:.4g} +- {:.4g}", prefix, level, range),
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
    hypothesis.line = line;
    list.push_back(std::move(hypothesis));
  }
  return list;
}

}  // namespace pellicle
