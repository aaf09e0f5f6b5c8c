#include "pellicle/fit/many.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numbers>

#include "pellicle/base/interrupt.h"
#include "pellicle/base/parallel.h"
#include "pellicle/energies/body.h"
#include "pellicle/fit/many_evidence.h"
#include "pellicle/fit/stage.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/seed/territories.h"

namespace pellicle {

namespace {

constexpr double kCap = 2.2;  // furthest from the centroid, in typical radii
constexpr double kFittedByScale =
    1.15;                            // radius of fitted surfaces over that of the scale space, on phantoms and stacks
constexpr double kSmoothing = 0.08;  // of the image forces, in typical radii

/// The start of one fit.
struct Start {
  std::size_t source = 0;  ///< number of the seed
  Vec3 position{0, 0, 0};  ///< whose territory it is, LPS mm
  double response = 0.0;
  std::optional<double> radius = {};    ///< mm, as the user said
  std::optional<Surface> surface = {};  ///< already near
  double around(double typical) const { return kCap * typical; }
};

/// One object on its way.
struct Candidate {
  Start start = {};
  FitState state;
  std::vector<StageSummary> stages = {};
  BodyEvidence evidence = {};
  double inside = 0.0, beyond = 0.0;  ///< levels of the last fit
  double weak_share = 0.0;
  double variation = 1.0;
  bool kept = true;
};

struct Scene {
  const Image<float>& image;  ///< smoothed for the image forces
  const ManySettings& settings;
  const BlobField& field;
  double radius;  ///< typical, mm
  Image<std::int32_t> territories;
  SurfaceModel model;
  int detail;
  std::vector<Stage> stages;
};

/// Which intensities a fit sees.
enum class Domain { stable, linear };

std::pair<SurfaceModel, int> model_of_many(const FitSettings& settings) {
  SurfaceModel model = start_model(settings.model);
  Surface surface{model, affine_image(model, Vec3::Zero(), Mat3::Identity())};
  int detail = 0;
  // About 26 control points: enough for the shape of a nucleus, few enough for thousands of them.
  const auto enough = [&] {
    return settings.detail ? detail >= *settings.detail : control_point_count(surface.model) >= 20;
  };
  while (!enough()) {
    surface = refine(surface);
    ++detail;
  }
  return {surface.model, detail};
}

/// Voxels of the territories' grid about a place.
IndexBox box_about(const ImageGrid& grid, const Vec3& x, double reach) {
  return box_around(grid, x - Vec3::Constant(reach), x + Vec3::Constant(reach), 0.0);
}

/// One object's territory: 1 inside, 0 elsewhere, and the box of what lies near the seed.
struct Territory {
  Image<float> own;
  Vec3 low{0, 0, 0}, high{0, 0, 0};
  Vec3 centre{0, 0, 0};  ///< centroid of what lies within 0.8 typical radii of the seed
  double radius = 0.0;   ///< of the ball of that volume
};

Territory territory_of(const Scene& scene, std::size_t object, const Start& start) {
  const Image<std::int32_t>& all = scene.territories;
  const double reach = start.around(scene.radius), near = 0.8 * scene.radius;
  const IndexBox box = box_about(all.grid, start.position, reach + 2.0 * all.grid.spacing.maxCoeff());
  Territory t;
  t.own.grid = all.grid;
  t.own.grid.size = box.size;
  t.own.grid.origin_in_world = all.grid.world_from_index(Vec3(box.begin[0], box.begin[1], box.begin[2]));
  t.own.voxels.resize(t.own.grid.voxel_count(), 0.0F);
  t.low = t.high = t.centre = start.position;
  const auto label = static_cast<std::int32_t>(object) + 1;
  Vec3 sum = Vec3::Zero();
  std::size_t count = 0;
  for (int k = 0; k < box.size[2]; ++k) {
    for (int j = 0; j < box.size[1]; ++j) {
      for (int i = 0; i < box.size[0]; ++i) {
        if (all.at(box.begin[0] + i, box.begin[1] + j, box.begin[2] + k) != label) continue;
        t.own.at(i, j, k) = 1.0F;
        const Vec3 x = t.own.grid.world_from_index(Vec3(i, j, k));
        const double apart = (x - start.position).norm();
        if (apart > reach) continue;
        t.low = t.low.cwiseMin(x);
        t.high = t.high.cwiseMax(x);
        if (apart > near) continue;
        sum += x;
        ++count;
      }
    }
  }
  if (count > 0) t.centre = sum / static_cast<double>(count);
  t.radius = std::cbrt(3.0 * static_cast<double>(count) * all.grid.voxel_volume() / (4.0 * std::numbers::pi));
  return t;
}

/// The piece of the image that one fit sees.
Image<float> piece_of(const Scene& scene, const Territory& territory, Domain domain) {
  const IndexBox box = box_around(scene.image.grid, territory.low, territory.high, 0.3 * scene.radius);
  Image<float> piece = crop_and_bin(scene.image, box, {1, 1, 1});
  const StableIntensity& intensity = scene.field.intensity;
  for (float& v : piece.voxels) v = domain == Domain::stable ? intensity(v) : intensity.linear(v);
  return piece;
}

/// As fits see it: voxels of a 16th of the radius at least, smoothed. Once for all, since pieces overlap.
Image<float> prepared(Image<float> image, const FitSettings& settings, double radius) {
  const Index3 factor = bin_factors(image.grid, radius / 16.0);
  if (!(factor == Index3{1, 1, 1})) image = crop_and_bin(image, {{0, 0, 0}, image.grid.size}, factor);
  return gaussian_smooth(std::move(image), settings.smoothing_mm.value_or(kSmoothing * radius));
}

FitState start_of(const Scene& scene, const Start& start, const Territory& territory) {
  FitState state{.surface = {scene.model, {}}, .detail = scene.detail};
  if (start.surface) {
    state.surface = *start.surface;
    state.detail = refinements_of(start.surface->model);
  } else if (start.radius) {
    const double r = std::clamp(*start.radius, 0.4 * scene.radius, 1.2 * scene.radius);
    state.surface.parameters = affine_image(scene.model, start.position, r * Mat3::Identity());
  } else {
    const double r = std::clamp(territory.radius, 0.4 * scene.radius, 0.8 * scene.radius);
    state.surface.parameters = affine_image(scene.model, territory.centre, r * Mat3::Identity());
  }
  state.reading.name = "one of many";
  return state;
}

void judge(const Scene& scene, GeometryCache& cache, const Image<float>& piece, const Territory& territory,
           Domain domain, Candidate& c) {
  const StageGeometry& geometry = cache.get(c.state.surface.model, 2);
  SurfaceSamples samples;
  evaluate(c.state.surface.model, c.state.surface.parameters, geometry.layout, false, samples);
  const std::vector<double> area = sample_areas(geometry.layout, samples.x);
  const BodyReading reading =
      read_body(TrilinearField(piece), samples.x, samples.normal, area,
                {.half_width = 0.35, .least_radius = 0.3 * scene.radius, .territory = &territory.own});
  c.inside = reading.inside;
  c.beyond = reading.beyond;
  const double volume = facet_volume(geometry.layout, samples.x);
  c.evidence = evidence_of_body(scene.image.grid, samples.x, area, reading);
  c.evidence.response = c.start.response;
  c.evidence.radius = std::cbrt(3.0 * volume / (4.0 * std::numbers::pi));
  double weak = 0.0;
  for (const double s : reading.support) weak += s < 0.25 ? 1.0 : 0.0;
  c.weak_share = weak / static_cast<double>(reading.support.size());
  if (domain == Domain::linear) return;
  // How uneven the object is, in linear intensities (v^2 - 1): a bright core in a faint rim, or one level.
  const auto linear = [](double v) { return v * v - 1.0; };
  const std::vector<double> values = values_inside(TrilinearField(piece), samples.x, reading.centroid, 4);
  std::vector<double> around;
  around.reserve(piece.voxels.size() / 8 + 1);
  for (std::size_t i = 0; i < piece.voxels.size(); i += 8) around.push_back(static_cast<double>(piece.voxels[i]));
  const double ground = linear(quantile_of(std::move(around), 0.05));
  const double middle = linear(quantile_of(values, 0.5)) - ground;
  c.variation = middle > 0.0 ? (linear(quantile_of(values, 0.95)) - ground) / middle : 1.0;
}

/// Fits every candidate that is still kept, from its own start.
void fit_all(const Scene& scene, GeometryCache& cache, Domain domain, const std::vector<double>* typical,
             std::vector<Candidate>& candidates, const std::function<void(double)>& tell) {
  FitSettings settings = scene.settings.fit;
  settings.smoothing_mm.reset();  // the piece is smoothed already
  std::atomic<std::size_t> done{0};
  parallel_for(candidates.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Candidate& c = candidates[i];
      if (!c.kept) continue;
      check_interrupt();
      const Territory territory = territory_of(scene, i, c.start);
      const Image<float> piece = piece_of(scene, territory, domain);
      c.state = start_of(scene, c.start, territory);
      c.state.crowd = {&territory.own, scene.radius, typical};
      c.stages.clear();
      const StageContext context{piece, settings, cache};
      for (const Stage& stage : scene.stages) {
        if (c.state.status == FitStatus::ok) c.stages.push_back(run_stage(context, stage, c.state));
      }
      judge(scene, cache, piece, territory, domain, c);
      c.state.crowd = {};
      const std::size_t now = ++done;
      if (tell && now % 16 == 0) tell(static_cast<double>(now) / static_cast<double>(candidates.size()));
    }
  });
}

std::size_t reject(std::vector<Candidate>& candidates, const std::vector<bool>& keep) {
  std::size_t gone = 0;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (candidates[i].kept && !keep[i]) {
      candidates[i].kept = false;
      ++gone;
    }
  }
  return gone;
}

std::vector<BodyEvidence> evidences(const std::vector<Candidate>& candidates) {
  std::vector<BodyEvidence> list;
  list.reserve(candidates.size());
  for (const Candidate& c : candidates) {
    list.push_back(c.evidence);
    if (c.state.status != FitStatus::ok) list.back().radius = 0.0;
  }
  return list;
}

std::vector<Surface> surfaces(const std::vector<Candidate>& candidates) {
  std::vector<Surface> list;
  list.reserve(candidates.size());
  for (const Candidate& c : candidates) list.push_back(c.state.surface);
  return list;
}

std::vector<bool> kept(const std::vector<Candidate>& candidates) {
  std::vector<bool> list;
  list.reserve(candidates.size());
  for (const Candidate& c : candidates) list.push_back(c.kept);
  return list;
}

/// Radius at every sample of the typical object: median over those that are seen well and whole.
std::vector<double> typical_radii(GeometryCache& cache, const std::vector<Candidate>& candidates) {
  std::vector<std::vector<double>> all;
  for (const bool strict : {true, false}) {
    for (const Candidate& c : candidates) {
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

double median_variation(const std::vector<Candidate>& candidates) {
  std::vector<double> values;
  for (const Candidate& c : candidates) {
    if (c.kept) values.push_back(c.variation);
  }
  return values.empty() ? 1.0 : median_of(values);
}

ManyObject object_of(const Scene& scene, std::size_t source, const Candidate& c) {
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

bool wants_dark(const Image<float>& image, const FitSettings& settings) {
  if (settings.polarity != Polarity::automatic) return settings.polarity == Polarity::dark;
  return looks_dark(image);
}

std::function<void(double)> part_of(const Progress& progress, double from, double to) {
  return [&progress, from, to](double share) {
    if (progress) progress(from + share * (to - from), "fitting");
  };
}

/// Fits in the stabilised image and judges them; then in the image itself. `found`: they were not asked for one by one.
ManyResult run(const Scene& scene, GeometryCache& cache, std::vector<Candidate> candidates, bool found,
               const Progress& progress) {
  ManyResult result;
  result.dark = scene.field.intensity.dark;
  result.radius = scene.radius;
  result.seeds = candidates.size();
  const std::vector<BodyEvidence> first = evidences(candidates);
  const double ground = ground_deviation(scene.field, scene.radius, surfaces(candidates), kept(candidates));
  const std::vector<bool> believable = like_the_others(first, typical_body(first), ground, scene.settings.radius);
  if (found) result.weak = reject(candidates, believable);
  std::vector<Candidate> stable = candidates;
  fit_all(scene, cache, Domain::linear, nullptr, candidates, part_of(progress, 0.55, 0.9));
  result.variation = median_variation(candidates);
  // Bright cores in faint rims: the linear image shows the cores only. There the stabilised one is kept, and what an
  // object of this kind looks like helps where its own rim does not.
  if (result.variation > 1.6) {
    const std::vector<double> typical = typical_radii(cache, stable);
    candidates = std::move(stable);
    if (!typical.empty()) {
      result.typical_shape = true;
      fit_all(scene, cache, Domain::stable, &typical, candidates, part_of(progress, 0.9, 1.0));
    }
  }
  for (Candidate& c : candidates) {
    if (found && c.state.status != FitStatus::ok && c.kept) {
      c.kept = false;
      ++result.weak;
    }
  }
  result.doubled = reject(candidates, not_doubled(surfaces(candidates), evidences(candidates), kept(candidates)));
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    Candidate& c = candidates[i];
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

double typical_given(const std::vector<Seed>& seeds) {
  std::vector<double> radii;
  radii.reserve(seeds.size());
  for (const Seed& seed : seeds) {
    const auto* ball = std::get_if<SeedSphere>(&seed);
    if (ball != nullptr) {
      radii.push_back(ball->radius);
    } else {
      const TriangleMesh mesh = tessellate(std::get<Surface>(seed), 2);
      radii.push_back(std::cbrt(3.0 * std::abs(volume_with_normals(mesh)) / (4.0 * std::numbers::pi)));
    }
  }
  return median_of(std::move(radii));
}

Vec3 middle_of(const Seed& seed) {
  const auto* ball = std::get_if<SeedSphere>(&seed);
  if (ball != nullptr) return ball->center;
  Vec3 sum = Vec3::Zero();
  const TriangleMesh mesh = tessellate(std::get<Surface>(seed), 2);
  for (const Vec3& v : mesh.vertices) sum += v;
  return sum / static_cast<double>(mesh.vertices.size());
}

/// Balls that are not in the object of an earlier one: half a radius from it, or a radius without a valley between.
std::vector<bool> without_repeats(const std::vector<Seed>& seeds, const Image<float>& response, double radius) {
  const TrilinearField field(response);
  std::vector<Vec3> accepted;
  std::vector<bool> own;
  own.reserve(seeds.size());
  accepted.reserve(seeds.size());
  for (const Seed& seed : seeds) {
    const Vec3 x = middle_of(seed);
    const bool repeats = std::any_of(accepted.begin(), accepted.end(), [&](const Vec3& other) {
      const double apart = (x - other).norm();
      if (apart >= radius) return false;
      if (apart < 0.5 * radius) return true;
      std::array<float, 17> line{};
      field.along_line(x, (other - x) / 16.0, 17, line.data());
      const float lowest = *std::min_element(line.begin(), line.end());
      return static_cast<double>(lowest) >= 0.9 * static_cast<double>(std::min(line.front(), line.back()));
    });
    own.push_back(!repeats);
    if (!repeats) accepted.push_back(x);
  }
  return own;
}

Scene scene_of(const Image<float>& image, const ManySettings& settings, const BlobField& field, double radius,
               const std::vector<Candidate>& candidates) {
  std::vector<Vec3> positions;
  positions.reserve(candidates.size());
  for (const Candidate& c : candidates) positions.push_back(c.start.position);
  const auto [model, detail] = model_of_many(settings.fit);
  return {image,
          settings,
          field,
          radius,
          territories_of(blob_response(field, radius, 0.8), positions),
          model,
          detail,
          stages_of_many(settings.fit)};
}

}  // namespace

std::vector<Stage> stages_of_many(const FitSettings& settings) {
  std::vector<Stage> stages = settings.stages;
  if (stages.empty()) {
    stages.push_back({.name = "body",
                      .detail = 0,
                      .energies = {{"body", 1.0}, {"bending", 4e-4}},
                      .resolution = 1.0,
                      .smoothing = 0.0,
                      .max_steps = 9,
                      .tolerance = 0.0,
                      .solver = Solver::dynamic,
                      .motion = {1.0, 0.0, 0.04}});
  }
  return with_settings(std::move(stages), settings);
}

ManyResult fit_many(Image<float> image, const ManySettings& settings, const Progress& progress) {
  settings.fit.validate();
  if (progress) progress(0.0, "looking for objects");
  const BlobField field = blob_field(image, wants_dark(image, settings.fit));
  const std::optional<double> estimate = estimate_radius(field, settings.radius);
  ManyResult nothing;
  nothing.dark = field.intensity.dark;
  if (!estimate) return nothing;
  double radius = *estimate;
  image = prepared(std::move(image), settings.fit, radius);
  GeometryCache cache;
  for (bool again = !settings.radius;; again = false) {
    std::vector<Candidate> candidates;
    for (const BlobSeed& seed : find_blobs(field, radius, settings.seeds)) {
      candidates.push_back(
          {.start = {.source = candidates.size(), .position = seed.position, .response = seed.response},
           .state = {.surface = {start_model(settings.fit.model), {}}}});
    }
    if (candidates.empty()) return nothing;
    if (progress) progress(0.1, "territories");
    const Scene scene = scene_of(image, settings, field, radius, candidates);
    fit_all(scene, cache, Domain::stable, nullptr, candidates, part_of(progress, 0.15, 0.55));
    // The objects themselves say best how large they are. Once, and not far from what the scales say.
    const double fitted = typical_body(evidences(candidates)).radius / kFittedByScale;
    const double seen = std::clamp(fitted, 0.75 * radius, radius / 0.75);
    if (again && std::abs(std::log(seen / radius)) > 0.05) {
      radius = seen;
      continue;
    }
    return run(scene, cache, std::move(candidates), true, progress);
  }
}

ManyResult fit_many(Image<float> image, const std::vector<Seed>& seeds, const ManySettings& settings,
                    const Progress& progress) {
  settings.fit.validate();
  if (seeds.empty()) return {};
  const BlobField field = blob_field(image, wants_dark(image, settings.fit));
  const double given = typical_given(seeds);
  // A click says little of the size; the image is asked, within a factor of two.
  const bool balls = std::holds_alternative<SeedSphere>(seeds.front());
  const RadiusRange range = settings.radius.value_or(RadiusRange{0.5 * given, 2.0 * given});
  const double radius = balls ? estimate_radius(field, range).value_or(given) : given;
  image = prepared(std::move(image), settings.fit, radius);
  std::vector<Candidate> candidates;
  const std::vector<bool> own =
      balls ? without_repeats(seeds, blob_response(field, radius, 0.9), radius) : std::vector<bool>(seeds.size(), true);
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    if (!own[i]) continue;
    const Seed& seed = seeds[i];
    Candidate c{.start = {.source = i, .position = middle_of(seed)},
                .state = {.surface = {start_model(settings.fit.model), {}}}};
    if (const auto* ball = std::get_if<SeedSphere>(&seed)) {
      c.start.radius = ball->radius;
    } else {
      c.start.surface = std::get<Surface>(seed);
    }
    candidates.push_back(std::move(c));
  }
  const Scene scene = scene_of(image, settings, field, radius, candidates);
  GeometryCache cache;
  fit_all(scene, cache, Domain::stable, nullptr, candidates, part_of(progress, 0.15, 0.55));
  const std::size_t repeats = seeds.size() - candidates.size();
  ManyResult result = run(scene, cache, std::move(candidates), false, progress);
  result.seeds = seeds.size();
  result.doubled += repeats;
  return result;
}

}  // namespace pellicle
