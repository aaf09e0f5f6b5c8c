#include "pellicle/fit/many/many.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numbers>

#include "pellicle/base/parallel.h"
#include "pellicle/energies/body.h"
#include "pellicle/energies/energy_kinds.h"
#include "pellicle/fit/many/many_evidence.h"
#include "pellicle/fit/many/many_piece.h"
#include "pellicle/fit/plan.h"
#include "pellicle/mesh/measure.h"

namespace pellicle {

namespace {

constexpr double kFittedByScale =
    1.15;  // radius of fitted surfaces over that of the scale space, on phantoms and stacks
/// One object as it is fitted.
struct ObjectFit {
  ManyStart start = {};
  Candidate state;
  std::vector<StageSummary> stages = {};
  BodyEvidence evidence = {};
  double inside = 0.0, beyond = 0.0;  ///< levels of the last fit
  double weak_share = 0.0;
  double variation = 1.0;
  bool kept = true;
};

void judge(const ManyScene& scene, GeometryCache& cache, const Image<float>& piece, const Territory& territory,
           Intensities intensities, ObjectFit& c) {
  const StageGeometry& geometry = cache.get(c.state.surface.model, 2);
  const SampledSurface samples(geometry.layout, c.state.surface);
  const BodyReading reading =
      read_body(TrilinearField(piece), samples,
                {.half_width = 0.35, .least_radius = 0.3 * scene.radius, .territory = &territory.own});
  c.inside = reading.inside;
  c.beyond = reading.beyond;
  const double volume = samples.volume();
  c.evidence = evidence_of_body(scene.image.grid, samples.x(), samples.area(), reading);
  c.evidence.response = c.start.response;
  c.evidence.radius = std::cbrt(3.0 * volume / (4.0 * std::numbers::pi));
  double weak = 0.0;
  for (const double s : reading.support) weak += s < 0.25 ? 1.0 : 0.0;
  c.weak_share = weak / static_cast<double>(reading.support.size());
  if (intensities == Intensities::original) return;
  // How uneven the object is, in linear intensities (v^2 - 1): a bright core in a faint rim, or one level.
  const auto linear = [](double v) { return v * v - 1.0; };
  const std::vector<double> values = values_inside(TrilinearField(piece), samples.x(), reading.centroid, 4);
  std::vector<double> around;
  around.reserve(piece.voxels.size() / 8 + 1);
  for (std::size_t i = 0; i < piece.voxels.size(); i += 8) around.push_back(static_cast<double>(piece.voxels[i]));
  const double ground = linear(quantile_of(std::move(around), 0.05));
  const double middle = linear(quantile_of(values, 0.5)) - ground;
  c.variation = middle > 0.0 ? (linear(quantile_of(values, 0.95)) - ground) / middle : 1.0;
}

/// Fits every candidate that is still kept, from its own start.
void fit_all(const ManyScene& scene, GeometryCache& cache, Intensities intensities, const std::vector<double>* typical,
             std::vector<ObjectFit>& candidates, const Observer& observer) {
  const ExpertPoints no_points;
  std::atomic<std::size_t> done{0};
  parallel_for(candidates.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      ObjectFit& c = candidates[i];
      if (!c.kept) continue;
      observer.check_stopped();
      const Territory territory = territory_of(scene, i, c.start);
      const Image<float> piece = piece_of(scene, territory, intensities);
      c.state = start_of(scene, c.start, territory);
      c.state.one_of_many = {&territory.own, scene.radius, typical};
      c.stages.clear();
      const StageContext context{piece, no_points, cache, observer};
      for (const Stage& stage : scene.stages) {
        if (c.state.status == FitStatus::ok) c.stages.push_back(run_stage(context, {stage}, c.state).summary);
      }
      judge(scene, cache, piece, territory, intensities, c);
      c.state.one_of_many = {};
      const std::size_t now = ++done;
      if (now % 16 == 0)
        observer.tell_progress(static_cast<double>(now) / static_cast<double>(candidates.size()), "fitting");
    }
  });
}

std::size_t reject(std::vector<ObjectFit>& candidates, const std::vector<bool>& keep) {
  std::size_t gone = 0;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (candidates[i].kept && !keep[i]) {
      candidates[i].kept = false;
      ++gone;
    }
  }
  return gone;
}

std::vector<BodyEvidence> evidence_of_all(const std::vector<ObjectFit>& candidates) {
  std::vector<BodyEvidence> list;
  list.reserve(candidates.size());
  for (const ObjectFit& c : candidates) {
    list.push_back(c.evidence);
    if (c.state.status != FitStatus::ok) list.back().radius = 0.0;
  }
  return list;
}

std::vector<Surface> surfaces(const std::vector<ObjectFit>& candidates) {
  std::vector<Surface> list;
  list.reserve(candidates.size());
  for (const ObjectFit& c : candidates) list.push_back(c.state.surface);
  return list;
}

std::vector<bool> kept(const std::vector<ObjectFit>& candidates) {
  std::vector<bool> list;
  list.reserve(candidates.size());
  for (const ObjectFit& c : candidates) list.push_back(c.kept);
  return list;
}

/// Radius at every sample of the typical object: median over those that are seen well and whole.
std::vector<double> typical_radii(GeometryCache& cache, const std::vector<ObjectFit>& candidates) {
  std::vector<std::vector<double>> all;
  for (const bool strict : {true, false}) {
    for (const ObjectFit& c : candidates) {
      if (!c.kept || (strict && (c.evidence.support < 0.55 || c.evidence.visible < 0.999))) continue;
      const StageGeometry& geometry = cache.get(c.state.surface.model, 2);
      SurfaceSamples samples;
      evaluate(c.state.surface.model, c.state.surface.parameters, geometry.layout, false, samples);
      const std::vector<double> area = sample_areas(geometry.layout, samples.x);
      Vec3 centre = Vec3::Zero();
      for (std::size_t i = 0; i < area.size(); ++i) centre += area[i] / sum(area) * samples.x[i];
      all.emplace_back();
      all.back().reserve(area.size());
      for (const Vec3& x : samples.x) all.back().push_back((x - centre).norm());
    }
    if (all.size() >= 3) break;
    all.clear();
  }
  std::vector<double> typical;
  for (std::size_t i = 0; !all.empty() && i < all.front().size(); ++i) {
    std::vector<double> here;
    here.reserve(all.size());
    for (const auto& one : all) here.push_back(one[i]);
    typical.push_back(median_of(std::move(here)));
  }
  return typical;
}

double median_variation(const std::vector<ObjectFit>& candidates) {
  std::vector<double> values;
  for (const ObjectFit& c : candidates) {
    if (c.kept) values.push_back(c.variation);
  }
  return values.empty() ? 1.0 : median_of(values);
}

ManyObject object_of(const ManyScene& scene, std::size_t source, const ObjectFit& c) {
  ManyObject object{source, c.state.surface, {}, c.evidence};
  FitSummary& s = object.summary;
  s.status = c.state.status;
  s.reason = c.state.reason;
  s.stages = c.stages;
  s.polarity = scene.field.intensity.dark ? Polarity::dark : Polarity::bright;
  s.boundary = Boundary::step;
  s.level_inside = c.inside;
  s.level_outside = c.beyond;
  s.evidence = {c.evidence.support, std::abs(c.inside - c.beyond), 0.0, c.weak_share, 1.0 - c.evidence.visible, 0.0};
  return object;
}

bool wants_dark(const Image<float>& image, const FitOptions& options) {
  if (options.polarity != Polarity::automatic) return options.polarity == Polarity::dark;
  return looks_dark(image);
}

/// Fits in the stabilised image and judges them; then in the image itself. `found`: they were not asked for one by one.
ManyResult run(const ManyScene& scene, GeometryCache& cache, std::vector<ObjectFit> candidates, bool found,
               const Observer& observer) {
  ManyResult result;
  result.dark = scene.field.intensity.dark;
  result.radius = scene.radius;
  result.seeds = candidates.size();
  const std::vector<BodyEvidence> first = evidence_of_all(candidates);
  const double ground = ground_deviation(scene.field, scene.radius, surfaces(candidates), kept(candidates));
  const std::vector<bool> believable = accepted_objects(first, typical_body(first), ground, scene.settings.radius);
  if (found) result.weak = reject(candidates, believable);
  std::vector<ObjectFit> stable = candidates;
  fit_all(scene, cache, Intensities::original, nullptr, candidates, observer.part(0.55, 0.9));
  result.variation = median_variation(candidates);
  // Bright cores in faint rims: the linear image shows the cores only. There the stabilised one is kept, and what an
  // object of this kind looks like helps where its own rim does not.
  if (result.variation > 1.6) {
    const std::vector<double> typical = typical_radii(cache, stable);
    candidates = std::move(stable);
    if (!typical.empty()) {
      result.typical_shape = true;
      fit_all(scene, cache, Intensities::stabilised, &typical, candidates, observer.part(0.9, 1.0));
    }
  }
  for (ObjectFit& c : candidates) {
    if (found && c.state.status != FitStatus::ok && c.kept) {
      c.kept = false;
      ++result.weak;
    }
  }
  result.doubled =
      reject(candidates, without_duplicates(surfaces(candidates), evidence_of_all(candidates), kept(candidates)));
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    ObjectFit& c = candidates[i];
    if (!c.kept) continue;
    // Judged in the stabilised image, whichever the last fit saw.
    const double radius = c.evidence.radius, visible = c.evidence.visible;
    c.evidence = first[i];
    c.evidence.radius = radius;
    c.evidence.visible = visible;
    if (!believable[i] && c.state.status == FitStatus::ok) {
      c.state.status = FitStatus::doubtful;
      c.state.reason = fmt::format("weak evidence beside the other objects (support {:.2f}, contrast {:.3g})",
                                   c.evidence.support, c.evidence.contrast);
    }
    result.objects.push_back(object_of(scene, c.start.source, c));
  }
  return result;
}

ManyScene scene_of(const Image<float>& image, const ManySettings& settings, const BlobField& field, double radius,
                   const std::vector<ObjectFit>& candidates) {
  std::vector<Vec3> positions;
  positions.reserve(candidates.size());
  for (const ObjectFit& c : candidates) positions.push_back(c.start.position);
  const auto [model, detail] = model_of_many(settings.fit);
  return {image,
          settings,
          field,
          radius,
          territories_of(blob_response(field, radius, 0.8), positions),
          model,
          detail,
          plan_for(settings.fit, StartKind::many, false).first.stages};
}

}  // namespace

std::vector<SeedSphere> detect_many(const Image<float>& image, const ManySettings& settings) {
  const BlobField field = blob_field(image, wants_dark(image, settings.fit));
  std::vector<SeedSphere> places;
  if (const std::optional<double> radius = estimate_radius(field, settings.radius)) {
    for (const BlobSeed& seed : find_blobs(field, *radius, settings.seeds)) {
      places.push_back({.center = seed.position, .radius = *radius});
    }
  }
  return places;
}

ManyResult fit_many(Image<float> image, const ManySettings& settings, const Observer& observer) {
  settings.fit.validate();
  observer.tell_progress(0.0, "looking for objects");
  const BlobField field = blob_field(image, wants_dark(image, settings.fit));
  const std::optional<double> estimate = estimate_radius(field, settings.radius);
  ManyResult nothing;
  nothing.dark = field.intensity.dark;
  if (!estimate) return nothing;
  double radius = *estimate;
  image = smoothed_for_many(std::move(image), settings.fit, radius);
  GeometryCache cache;
  for (bool again = !settings.radius;; again = false) {
    std::vector<ObjectFit> candidates;
    for (const BlobSeed& seed : find_blobs(field, radius, settings.seeds)) {
      candidates.push_back(
          {.start = {.source = candidates.size(), .position = seed.position, .response = seed.response},
           .state = {.surface = {start_model(settings.fit.model), {}}}});
    }
    if (candidates.empty()) return nothing;
    observer.tell_progress(0.1, "territories");
    const ManyScene scene = scene_of(image, settings, field, radius, candidates);
    fit_all(scene, cache, Intensities::stabilised, nullptr, candidates, observer.part(0.15, 0.55));
    // The objects themselves say best how large they are. Once, and not far from what the scales say.
    const double fitted = typical_body(evidence_of_all(candidates)).radius / kFittedByScale;
    const double seen = std::clamp(fitted, 0.75 * radius, radius / 0.75);
    if (again && std::abs(std::log(seen / radius)) > 0.05) {
      radius = seen;
      continue;
    }
    return run(scene, cache, std::move(candidates), true, observer);
  }
}

ManyResult fit_many(Image<float> image, const std::vector<Seed>& seeds, const ManySettings& settings,
                    const Observer& observer) {
  settings.fit.validate();
  if (seeds.empty()) return {};
  const BlobField field = blob_field(image, wants_dark(image, settings.fit));
  const double given = typical_radius_of_seeds(seeds);
  // A click says little of the size; the image is asked, within a factor of two.
  const bool balls = std::holds_alternative<SeedSphere>(seeds.front());
  const RadiusRange range = settings.radius.value_or(RadiusRange{0.5 * given, 2.0 * given});
  const double radius = balls ? estimate_radius(field, range).value_or(given) : given;
  image = smoothed_for_many(std::move(image), settings.fit, radius);
  std::vector<ObjectFit> candidates;
  const std::vector<bool> own =
      balls ? without_repeats(seeds, blob_response(field, radius, 0.9), radius) : std::vector<bool>(seeds.size(), true);
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    if (!own[i]) continue;
    const Seed& seed = seeds[i];
    ObjectFit c{.start = {.source = i, .position = middle_of(seed)},
                .state = {.surface = {start_model(settings.fit.model), {}}}};
    if (const auto* ball = std::get_if<SeedSphere>(&seed)) {
      c.start.radius = ball->radius;
    } else {
      c.start.surface = std::get<Surface>(seed);
    }
    candidates.push_back(std::move(c));
  }
  const ManyScene scene = scene_of(image, settings, field, radius, candidates);
  GeometryCache cache;
  fit_all(scene, cache, Intensities::stabilised, nullptr, candidates, observer.part(0.15, 0.55));
  const std::size_t repeats = seeds.size() - candidates.size();
  ManyResult result = run(scene, cache, std::move(candidates), false, observer);
  result.seeds = seeds.size();
  result.doubled += repeats;
  return result;
}

}  // namespace pellicle
