#include "pellicle/output/seed_preview.h"

#include <fmt/format.h>

#include <algorithm>

#include "pellicle/base/errors.h"
#include "pellicle/image/reorder.h"
#include "pellicle/output/outputs.h"
#include "pellicle/output/seed_files.h"
#include "pellicle/picture/slice_rows.h"
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

/// What a run would start from: objects that were asked for, or places where `objects` many would look for some.
struct Starts {
  std::vector<ObjectSeed> seeds;
  bool looked_for = false;
};

Starts starts_of(const SegmentSettings& settings, const Volume& volume, const Image<float>& image) {
  Starts starts;
  if (!(volume.max > volume.min)) return starts;
  starts.seeds = read_seeds(settings, volume.header.grid, image);
  starts.looked_for = settings.wants_many() && starts.seeds.empty();
  if (!starts.looked_for) return starts;
  for (const SeedSphere& place : detect_many(image, many_settings(options_of(settings, volume.header.grid)))) {
    const int label = static_cast<int>(starts.seeds.size()) + 1;
    starts.seeds.push_back({.label = label, .name = fmt::format("place-{}", label), .candidates = {place}});
  }
  return starts;
}

std::vector<PictureRow> rows_of(const std::vector<ObjectSeed>& seeds, const std::string& stem, bool many) {
  std::vector<PictureRow> rows;
  if (many) {
    PictureRow all{.title = fmt::format("{}   {} places", stem, seeds.size()), .mesh = {}};
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

void add_lines(const SegmentSettings& settings, const Starts& starts, SeedPreview& preview) {
  preview.lines.push_back(
      fmt::format("{} {}", starts.seeds.size(), starts.looked_for ? "places to try" : "objects to fit"));
  std::vector<int> labels;
  for (const ObjectSeed& seed : starts.seeds) {
    if (!starts.looked_for) labels.push_back(seed.label);
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
                                                               : ", but it exists: give `overwrite`"));
  }
}

}  // namespace

SeedPreview preview_seeds(const SegmentSettings& settings, const Observer& observer) {
  settings.validate();
  check_seed_files(settings);
  const Volume volume = read_volume(settings.input, {settings.spacing, 0});
  for (const auto& warning : volume.header.warnings) {
    observer.tell_warning(fmt::format("{}: {}", settings.input.string(), warning));
  }
  SegmentSettings resolved = settings;
  resolved.fit.model.kind = settings.model_kind();
  const Image<float> image = in_lps_order(volume.image);
  const Starts starts = starts_of(resolved, volume, image);
  SeedPreview preview{.picture = settings.output / (stem_of(settings) + "_seeds.png"), .lines = {}};
  check_outputs({preview.picture}, true, {settings.input});
  create_folder(settings.output);
  write_png(preview.picture, draw_slice_rows(image, rows_of(starts.seeds, stem_of(settings), settings.wants_many())));
  add_lines(settings, starts, preview);
  return preview;
}

}  // namespace pellicle
