#include "pellicle/pipeline/morph.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "pellicle/base/atomic_file.h"
#include "pellicle/base/errors.h"
#include "pellicle/base/interrupt.h"
#include "pellicle/base/parallel.h"
#include "pellicle/mesh/distance.h"
#include "pellicle/pipeline/contact_sheet.h"
#include "pellicle/pipeline/outputs.h"
#include "pellicle/pipeline/provenance.h"
#include "pellicle/surface/model_file.h"

namespace pellicle {
namespace fs = std::filesystem;

namespace {

constexpr int most_facets = 120000;

std::string stem_of_model(const fs::path& path) {
  std::string stem = path.stem().string();
  const std::string suffix = "_model";
  if (stem.size() > suffix.size() && stem.ends_with(suffix)) stem.resize(stem.size() - suffix.size());
  return stem;
}

fs::path file_of(const MorphSettings& settings, const std::string& suffix) {
  return settings.output / (stem_of(settings) + "_morph" + suffix);
}

std::string number_of_step(std::size_t step) {
  return fmt::format("-{:03}", step + 1);
}

/// Kind and path of every file, the report last.
std::vector<std::pair<std::string, fs::path>> planned(const MorphSettings& settings) {
  std::vector<std::pair<std::string, fs::path>> files;
  const std::string extension = "_surface" + extension_of(settings.mesh_format);
  for (std::size_t i = 0; i < static_cast<std::size_t>(settings.steps); ++i) {
    files.emplace_back("mesh", file_of(settings, number_of_step(i) + extension));
    files.emplace_back("model", file_of(settings, number_of_step(i) + "_model.json"));
  }
  files.emplace_back("table", file_of(settings, ".tsv"));
  files.emplace_back("picture", file_of(settings, ".png"));
  files.emplace_back("report", file_of(settings, ".json"));
  return files;
}

/// One density for all steps, so that their meshes correspond vertex by vertex.
int mesh_level(const MorphSettings& settings, const MatchedSurfaces& surfaces) {
  if (settings.mesh_density) return *settings.mesh_density;
  int level = std::max(viewing_level(surfaces.a), viewing_level(surfaces.b));
  while (level > 2 && (base_facets(surfaces.a.model) << (2 * level)) > most_facets) --level;
  return level;
}

MorphStep measured(double tau, Surface surface, int level) {
  MorphStep step{.tau = tau, .surface = std::move(surface)};
  step.mesh = tessellate(step.surface, level);
  const MeshTopology topology = topology_of(step.mesh);
  step.watertight = topology.closed && topology.manifold && topology.oriented;
  step.genus = topology.genus;
  constexpr int dense = 4;  // coarse meshes still get the figures of the smooth surface
  const TriangleMesh fine = level < dense ? tessellate(step.surface, dense) : step.mesh;
  step.area_mm2 = area_of(fine);
  step.self_intersections = self_intersection_count(step.mesh);
  if (step.self_intersections > 0) step.status = FitStatus::folded;
  if (!step.watertight) return step;
  step.volume_ml = volume_with_normals(fine) / 1000.0;
  if (*step.volume_ml < 0.0) {
    step.status = FitStatus::inside_out;
    step.volume_ml = -*step.volume_ml;
    for (auto& triangle : step.mesh.triangles) std::swap(triangle[1], triangle[2]);
    for (auto& normal : step.mesh.normals) normal = -normal;
  }
  return step;
}

/// How far refinement moved a surface, mm.
double moved(const Surface& before, const Surface& after, bool changed) {
  if (!changed) return 0.0;
  const auto mesh = [](const Surface& surface) { return tessellate(surface, viewing_level(surface)); };
  return surface_distances(mesh(before), mesh(after), 1.0).hd;
}

std::string caption_of(const MorphStep& step) {
  return step.status == FitStatus::ok ? fmt::format("{:.4g}", step.tau)
                                      : fmt::format("{:.4g} {}", step.tau, to_string(step.status));
}

void draw(const MorphResult& result, const fs::path& path) {
  std::vector<SheetPanel> panels;
  panels.reserve(result.steps.size());
  for (const MorphStep& step : result.steps) panels.push_back({&step.mesh, caption_of(step)});
  const MorphSettings& s = result.settings;
  write_png(path, contact_sheet(panels, fmt::format("{} (0) to {} (1), {}", stem_of_model(s.a), stem_of_model(s.b),
                                                    name_of(s.space))));
}

std::string table_of(const MorphResult& result) {
  std::string text = "step\ttau\tvolume_ml\tarea_mm2\tself_intersections\tstatus\n";
  for (std::size_t i = 0; i < result.steps.size(); ++i) {
    const MorphStep& s = result.steps[i];
    text += fmt::format("{}\t{}\t{}\t{:.8g}\t{}\t{}\n", i + 1, s.tau,
                        s.volume_ml ? fmt::format("{:.8g}", *s.volume_ml) : "n/a", s.area_mm2, s.self_intersections,
                        to_string(s.status));
  }
  return text;
}

void write_steps(const MorphResult& result) {
  const MorphSettings& settings = result.settings;
  const std::string extension = "_surface" + extension_of(settings.mesh_format);
  for (std::size_t i = 0; i < result.steps.size(); ++i) {
    write_mesh(file_of(settings, number_of_step(i) + extension), result.steps[i].mesh, settings.mesh_format);
    write_model(file_of(settings, number_of_step(i) + "_model.json"), result.steps[i].surface);
    check_interrupt();
  }
}

}  // namespace

std::string stem_of(const MorphSettings& settings) {
  if (!settings.name.empty()) return settings.name;
  return stem_of_model(settings.a) + "_to_" + stem_of_model(settings.b);
}

std::vector<double> taus_of(const MorphSettings& settings) {
  if (settings.steps == 1) return {0.5 * (settings.from + settings.to)};
  std::vector<double> taus;
  taus.reserve(static_cast<std::size_t>(settings.steps));
  for (int i = 0; i < settings.steps; ++i) {
    const double tau = settings.from + (settings.to - settings.from) * i / (settings.steps - 1);
    const double end = std::round(tau);  // rounding must not miss A and B, which are exact there only
    taus.push_back(std::abs(tau - end) < 1e-12 ? end : tau);
  }
  return taus;
}

int MorphResult::exit_code() const {
  const bool all_ok =
      std::all_of(steps.begin(), steps.end(), [](const MorphStep& step) { return step.status == FitStatus::ok; });
  return all_ok ? 0 : 3;
}

MorphResult morph(const MorphSettings& settings, const RunContext& context) {
  settings.validate();
  const ThreadLimit limit(settings.threads);
  const auto tell = [&context](double share, const std::string& what) {
    if (context.progress) context.progress(share, what);
    check_interrupt();
  };
  const auto files = planned(settings);
  std::vector<fs::path> paths;
  paths.reserve(files.size());
  for (const auto& [kind, path] : files) paths.push_back(path);
  check_outputs(paths, settings.overwrite, {settings.a, settings.b});

  MorphResult result;
  result.settings = settings;
  PhaseClock clock;
  clock.start("read");
  tell(0.0, "reading");
  const Surface a = read_model(settings.a), b = read_model(settings.b);
  result.inputs = {{"a", settings.a, sha256_of(settings.a)}, {"b", settings.b, sha256_of(settings.b)}};
  clock.start("match");
  const MatchedSurfaces matched = match_surfaces(a, b);
  result.points_a = control_point_count(a.model);
  result.points_b = control_point_count(b.model);
  result.points = control_point_count(matched.a.model);
  result.moved_a_mm = moved(a, matched.a, matched.a_changed);
  result.moved_b_mm = moved(b, matched.b, matched.b_changed);
  const MorphPath path = morph_path(matched, settings.space);
  result.moments = path.moments;
  clock.start("morph");
  const std::vector<double> taus = taus_of(settings);
  const int level = mesh_level(settings, matched);
  for (std::size_t i = 0; i < taus.size(); ++i) {
    tell(0.1 + 0.6 * static_cast<double>(i) / static_cast<double>(taus.size()), "morphing");
    result.steps.push_back(measured(taus[i], surface_at(path, taus[i]), level));
  }
  clock.start("write");
  tell(0.7, "writing");
  create_folder(settings.output);
  write_steps(result);
  write_text_file(file_of(settings, ".tsv"), table_of(result));
  clock.start("picture");
  tell(0.9, "drawing");
  draw(result, file_of(settings, ".png"));
  clock.start("provenance");
  for (const auto& [kind, file] : files) {
    if (kind != "report") result.outputs.push_back({kind, file, sha256_of(file), fs::file_size(file)});
  }
  clock.stop();
  result.seconds = clock.seconds();
  write_text_file(file_of(settings, ".json"), report_of(result, context.command_line).dump(2) + "\n");
  if (context.progress) context.progress(1.0, "done");
  return result;
}

}  // namespace pellicle
