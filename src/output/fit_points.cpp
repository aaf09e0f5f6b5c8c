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

bool GeometryFitSettings::writes(const std::string& kind) const {
  return std::find(write.begin(), write.end(), kind) != write.end();
}

std::vector<int> GeometryFitSettings::rungs() const {
  if (model.kind != ModelKind::spline || !detail || tolerance_mm || tolerance_percent) return ladder;
  std::vector<int> sizes;
  for (int k = 0; k <= *detail; ++k) sizes.push_back(kFirstRung << k);
  return sizes;
}

void GeometryFitSettings::validate() const {
  const auto refuse = [](const std::string& key, const std::string& value, const std::string& rule) {
    throw SettingError("bad value", key, value, rule);
  };
  const bool spline = model.kind == ModelKind::spline;
  const int most_detail = spline ? 3 : 12;
  if (detail && (*detail < 0 || *detail > most_detail)) {
    refuse("detail", std::to_string(*detail),
           spline ? "must be 0 to 3: splines of 10, 20, 40, 80 points each way" : "must be 0 to 12");
  }
  if (tolerance_mm && !(*tolerance_mm > 0.0))
    refuse("tolerance-mm", fmt::format("{}", *tolerance_mm), "must be positive");
  if (tolerance_percent && !(*tolerance_percent > 0.0))
    refuse("tolerance-percent", fmt::format("{}", *tolerance_percent), "must be positive");
  if (tolerance_mm && tolerance_percent)
    throw SettingError("conflicting settings", "tolerance-mm, tolerance-percent", "give one of them");
  if (!(smoothness > 0.0 && std::isfinite(smoothness)))
    refuse("smoothness", fmt::format("{}", smoothness), "must be positive");
  if (mesh_density && (*mesh_density < 0 || *mesh_density > 7))
    refuse("mesh-density", std::to_string(*mesh_density), "must be 0 to 7 (2^N facets along a control edge)");
  if (open && model.kind != ModelKind::catmull_clark)
    throw SettingError("setting without its model", "open", "surfaces with a rim are fitted by `model` catmull-clark");
  if ((size || !ladder.empty()) && !spline)
    throw SettingError("setting without its model", "size, ladder", "they are about splines; give `model` spline");
  if ((size ? 1 : 0) + (ladder.empty() ? 0 : 1) + (detail || tolerance_mm || tolerance_percent ? 1 : 0) > 1) {
    throw SettingError("conflicting settings", "size, ladder, detail, tolerance-mm, tolerance-percent",
                       "each says how many control points there are; give one");
  }
  if (size && ((*size)[0] < 4 || (*size)[1] < 2 || (*size)[0] > 100 || (*size)[1] > 100)) {
    refuse("size", fmt::format("{},{}", (*size)[0], (*size)[1]), "M1 must be 4 to 100 and M2 2 to 100");
  }
  for (const int m : ladder) {
    if (m < 4 || m > 100) refuse("ladder", std::to_string(m), "each M must be 4 to 100");
  }
  for (const std::string& kind : write) {
    if (kind != "mesh" && kind != "model" && kind != "report") refuse("write", kind, "choose from mesh, model, report");
  }
  if (write.empty()) throw SettingError("bad value", "write", "nothing is to be written; choose from mesh, model, report");
  if (threads < 0) refuse("threads", std::to_string(threads), "must be 0 (all) or more");
}

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
