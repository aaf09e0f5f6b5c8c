#include "pellicle/output/fit_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "pellicle/base/atomic_file.h"
#include "pellicle/base/errors.h"
#include "pellicle/base/parallel.h"
#include "pellicle/output/fit_levels.h"
#include "pellicle/output/fit_report.h"
#include "pellicle/output/outputs.h"
#include "pellicle/output/provenance.h"
#include "pellicle/output/seed_files.h"
#include "pellicle/surface/model_file.h"

namespace pellicle {
namespace fs = std::filesystem;

namespace {

std::string stem_of(const GeometryFitSettings& settings) {
  if (!settings.name.empty()) return settings.name;
  SegmentSettings like;
  like.input = parse_mask_argument(settings.input).file;
  std::string stem = pellicle::stem_of(like);
  // Extensions that only geometry has.
  const fs::path path(stem);
  const std::string extension = path.extension().string();
  for (const char* known : {".ply", ".obj", ".stl", ".off", ".vtp", ".gii", ".xyz", ".pts", ".csv", ".pcd"}) {
    if (extension == known) return path.stem().string();
  }
  return stem;
}

std::vector<PlannedFile> plan_of(const GeometryFitSettings& settings) {
  const std::string stem = stem_of(settings);
  std::vector<PlannedFile> plan;
  const auto add = [&](const std::string& kind, const std::string& suffix) {
    plan.push_back({kind, 0, settings.output / (stem + suffix)});
  };
  if (settings.writes("mesh")) add("mesh", "_surface" + extension_of(settings.mesh_format));
  if (settings.writes("model")) add("model", "_model.json");
  if (!settings.ladder.empty()) add("ladder", "_ladder.png");
  if (settings.writes("report")) add("report", "_report.json");
  return plan;
}

int density_for(const Surface& surface) {
  int level = 6;
  while (level > 2 && base_facets(surface.model) * std::pow(4.0, level) > 120000.0) --level;
  return level;
}

void measure_mesh(GeometryFitResult& result) {
  const Surface& surface = result.tried[result.chosen].fit.surface;
  result.mesh = tessellate(surface, result.settings.mesh_density.value_or(density_for(surface)));
  for (const Vec3& v : result.mesh.vertices) {
    if (!v.allFinite()) throw Failure("fit failed (surface): it is not finite; please report this");
  }
  const bool closed = is_closed(surface.model);
  if (closed && volume_of(result.mesh) < 0.0) {
    for (auto& t : result.mesh.triangles) std::swap(t[1], t[2]);
    for (Vec3& n : result.mesh.normals) n = -n;
  }
  result.topology = topology_of(result.mesh);
  result.volume_ml = closed ? std::abs(volume_with_normals(tessellate(surface, density_for(surface)))) / 1000.0
                            : std::numeric_limits<double>::quiet_NaN();
  result.area_mm2 = area_of(result.mesh);
}

void write_outputs(const std::vector<PlannedFile>& plan, const Observer& observer, GeometryFitResult& result) {
  const GeometryFitSettings& settings = result.settings;
  create_folder(settings.output);
  if (settings.writes("mesh")) write_mesh(path_of(plan, "mesh"), result.mesh, settings.mesh_format);
  if (settings.writes("model")) write_model(path_of(plan, "model"), result.tried[result.chosen].fit.surface);
  if (!settings.ladder.empty()) write_ladder_picture(path_of(plan, "ladder"), result);
  observer.check_stopped();
  for (const auto& file : plan) {
    if (file.kind != "report") result.outputs.push_back(described(file.kind, file.path));
  }
}

}  // namespace

int GeometryFitResult::exit_code() const {
  if (!settings.ladder.empty()) {
    return std::all_of(tried.begin(), tried.end(), [](const FittedSurface& f) { return f.status == "ok"; }) ? 0 : 3;
  }
  return tried[chosen].status == "ok" ? 0 : 3;
}

std::string heading_of_fits() {
  return fmt::format("{:>12} {:>6} {:>10} {:>8} {:>10} {:>8} {:>5} {:>6}  {:<16} {:>8}", "size", "points", "rms_mm",
                     "rms_%", "max_mm", "max_%", "genus", "cuts", "status", "seconds");
}

std::string line_of(const FittedSurface& fitted, double diameter) {
  const PointFitSummary& s = fitted.fit.summary;
  return fmt::format("{:>12} {:>6} {:>10.4g} {:>8.4f} {:>10.4g} {:>8.4f} {:>5} {:>6}  {:<16} {:>8.2f}", fitted.name,
                     s.control_points, s.to_surface.rms, 100.0 * s.to_surface.rms / diameter, s.to_surface.max,
                     100.0 * s.to_surface.max / diameter, s.genus, s.self_intersections, fitted.status, s.seconds);
}

GeometryFitResult fit_to_files(const GeometryFitSettings& settings, const RunRecord& record, const Observer& observer) {
  const ThreadLimit limit(settings.threads);
  settings.validate();
  GeometryFitResult result;
  result.settings = settings;
  result.settings.ladder = settings.rungs();
  PhaseClock clock;
  clock.start("read");
  const fs::path file = parse_mask_argument(settings.input).file;
  std::error_code ignored;
  if (!fs::exists(file, ignored)) {
    throw NoInput(fmt::format("no such file (`input` {}): nothing is there; check the path", file.string()));
  }
  const std::vector<PlannedFile> plan = plan_of(result.settings);
  check_outputs(paths_of(plan), settings.overwrite, {file});
  result.input = read_geometry(settings.input, settings.open);
  check_model(settings.model.kind, result.input);
  for (const auto& warning : result.input.warnings) {
    observer.tell_warning(fmt::format("{}: {}", file.string(), warning));
  }
  clock.start("fit");
  fit_levels(observer, result);
  clock.start("measure");
  measure_mesh(result);
  clock.start("write");
  result.inputs.push_back({result.input.kind, file, sha256_of(file)});
  write_outputs(plan, observer, result);
  clock.stop();
  result.seconds = clock.seconds();
  if (settings.writes("report")) write_text_file(path_of(plan, "report"), report_of(result, record).dump(2) + "\n");
  observer.tell_progress(1.0, "done");
  return result;
}

}  // namespace pellicle
