#include "pellicle/pipeline/seed_preview.h"

#include <fmt/format.h>

#include <algorithm>

#include "pellicle/base/errors.h"
#include "pellicle/fit/expert_points.h"
#include "pellicle/image/reorder.h"
#include "pellicle/pipeline/outputs.h"
#include "pellicle/pipeline/qc_picture.h"
#include "pellicle/pipeline/seeding.h"
#include "pellicle/seed/blob_scale_space.h"
#include "pellicle/surface/icosphere.h"

namespace pellicle {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostLines = 50;

TriangleMesh ball_mesh(const SeedSphere& ball) {
  const Icosphere unit = icosphere(3);
  TriangleMesh mesh;
  mesh.triangles = unit.triangles;
  mesh.normals = unit.directions;
  for (const Vec3& d : unit.directions) mesh.vertices.emplace_back(ball.center + ball.radius * d);
  return mesh;
}

TriangleMesh mesh_of_seed(const Seed& seed) {
  if (const auto* ball = std::get_if<SeedSphere>(&seed)) return ball_mesh(*ball);
  TriangleMesh mesh = tessellate(std::get<Surface>(seed), 3);
  turn_outward(mesh);
  return mesh;
}

std::string words_of(const Seed& seed) {
  const auto* ball = std::get_if<SeedSphere>(&seed);
  if (ball == nullptr) return fmt::format("a surface of {:.4g} ml", volume_of(mesh_of_seed(seed)) / 1000.0);
  return fmt::format("a ball at {:.4g},{:.4g},{:.4g} LPS mm, radius {:.4g} mm", ball->center[0], ball->center[1],
                     ball->center[2], ball->radius);
}

// Where --objects many would look: the detection alone.
std::vector<ObjectSeed> places_of_many(const SegmentSettings& settings, const Image<float>& image) {
  std::vector<ObjectSeed> seeds;
  const Polarity polarity = settings.fit.polarity;
  const bool dark = polarity == Polarity::automatic ? looks_dark(image) : polarity == Polarity::dark;
  const BlobField field = blob_field(image, dark);
  const std::optional<double> radius = estimate_radius(field, settings.radius);
  if (!radius) return seeds;
  for (const BlobSeed& blob : find_blobs(field, *radius, {.valley = settings.valley})) {
    ObjectSeed seed{.label = static_cast<int>(seeds.size()) + 1, .name = "", .candidates = {}};
    seed.name = fmt::format("place-{}", seed.label);
    seed.candidates = {SeedSphere{blob.position, *radius}};
    seeds.push_back(std::move(seed));
  }
  return seeds;
}

void append(TriangleMesh& all, const TriangleMesh& part) {
  const auto first = static_cast<int>(all.vertices.size());
  all.vertices.insert(all.vertices.end(), part.vertices.begin(), part.vertices.end());
  all.normals.insert(all.normals.end(), part.normals.begin(), part.normals.end());
  for (const auto& t : part.triangles) all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

std::vector<PictureRow> rows_of(const std::vector<ObjectSeed>& seeds, const std::string& stem, bool many) {
  std::vector<PictureRow> rows;
  if (many) {
    PictureRow all{fmt::format("{}   {} places", stem, seeds.size()), {}};
    for (const ObjectSeed& seed : seeds) append(all.mesh, mesh_of_seed(seed.candidates.front()));
    if (!seeds.empty()) rows.push_back(std::move(all));
    return rows;
  }
  for (const ObjectSeed& seed : seeds) {
    for (std::size_t c = 0; c < seed.candidates.size(); ++c) {
      const std::string which = seed.candidates.size() > 1 ? fmt::format("   candidate {}", c + 1) : std::string();
      rows.push_back(
          {fmt::format("{} {} {}{}   seed", stem, seed.label, seed.name, which), mesh_of_seed(seed.candidates[c])});
    }
  }
  return rows;
}

void add_lines(const SegmentSettings& settings, const std::vector<ObjectSeed>& seeds, SeedPreview& preview) {
  const bool looked_for = settings.wants_many() && !seeds.empty() && seeds.front().name == "place-1";
  preview.lines.push_back(fmt::format("{} {}", seeds.size(), looked_for ? "places to try" : "objects to fit"));
  std::vector<int> labels;
  for (const ObjectSeed& seed : seeds) {
    if (!looked_for) labels.push_back(seed.label);
    for (const Seed& candidate : seed.candidates) {
      if (preview.lines.size() <= kMostLines)
        preview.lines.push_back(fmt::format("{} {}: {}", seed.label, seed.name, words_of(candidate)));
    }
  }
  for (const PlannedFile& file : plan_outputs(settings, labels)) {
    std::error_code ignored;
    const bool exists = fs::exists(file.path, ignored);
    if (file.label <= 1 || preview.lines.size() <= kMostLines)
      preview.lines.push_back(fmt::format("would write {}{}", file.path.string(),
                                          !exists              ? ""
                                          : settings.overwrite ? ", replacing what is there"
                                                               : ", but it exists: give --overwrite"));
  }
}

}  // namespace

SeedPreview preview_seeds(const SegmentSettings& settings, const RunContext& context) {
  settings.validate();
  check_seed_files(settings);
  const Volume volume = read_volume(settings.input, {settings.spacing, 0});
  for (const auto& warning : volume.header.warnings) {
    if (context.warn) context.warn(fmt::format("{}: {}", settings.input.string(), warning));
  }
  SegmentSettings resolved = settings;
  resolved.fit.model.kind = settings.model_kind();
  if (settings.points) resolved.fit.points = read_expert_points(settings, volume.header.grid);
  const Image<float> image = in_lps_order(volume.image);
  std::vector<ObjectSeed> seeds;
  if (volume.max > volume.min) seeds = make_seeds(resolved, volume.header.grid, image);
  const bool look = settings.wants_many() && seeds.empty() && volume.max > volume.min;
  if (look) seeds = places_of_many(settings, image);
  SeedPreview preview{.picture = settings.output / (stem_of(settings) + "_seeds.png"), .lines = {}};
  check_outputs({preview.picture}, true, {settings.input});
  create_folder(settings.output);
  write_pictures(preview.picture, image, rows_of(seeds, stem_of(settings), settings.wants_many()));
  add_lines(settings, seeds, preview);
  return preview;
}

}  // namespace pellicle
