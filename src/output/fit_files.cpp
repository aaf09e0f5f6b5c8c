#include "pellicle/output/fit_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "pellicle/base/atomic_file.h"
#include "pellicle/base/errors.h"
#include "pellicle/base/parallel.h"
#include "pellicle/output/fit_report.h"
#include "pellicle/output/geometry_files.h"
#include "pellicle/output/outputs.h"
#include "pellicle/output/seed_files.h"
#include "pellicle/picture/canvas.h"
#include "pellicle/settings/settings.h"
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

void write_outputs(const std::vector<PlannedFile>& plan, const Observer& observer, GeometryFitResult& result) {
  const GeometryFitSettings& settings = result.settings;
  create_folder(settings.output);
  if (settings.writes("mesh")) write_mesh(path_of(plan, "mesh"), result.fit.mesh, settings.mesh_format);
  if (settings.writes("model")) write_model(path_of(plan, "model"), result.fit.sizes.best().fit.surface);
  if (!settings.ladder.empty()) write_png(path_of(plan, "ladder"), ladder_picture(result));
  observer.check_stopped();
  for (const auto& file : plan) {
    if (file.kind != "report") result.outputs.push_back(described(file.kind, file.path));
  }
}

void check_model(ModelKind kind, const GeometryInput& input) {
  if (takes(kind, input)) return;
  throw SettingError("bad value", "model", name_of(kind),
                     input.grid ? "a grid of points (u_index, v_index) is interpolated by a spline; give `model` "
                                  "spline, spline-torus, spline-cylinder or spline-rectangle"
                                : "points without a grid are fitted by normal, spline, catmull-clark and slime");
}

}  // namespace

int GeometryFitResult::exit_code() const {
  const auto is_ok = [](const FittedSurface& fitted) { return fitted.status == SizeStatus::ok; };
  const std::vector<FittedSurface>& tried = fit.sizes.tried;
  const bool ok = settings.ladder.empty() ? is_ok(fit.sizes.best()) : std::all_of(tried.begin(), tried.end(), is_ok);
  return ok ? 0 : 3;
}

std::string heading_of_fits() {
  return fmt::format("{:>12} {:>6} {:>10} {:>8} {:>10} {:>8} {:>5} {:>6}  {:<16} {:>8}", "size", "points", "rms_mm",
                     "rms_%", "max_mm", "max_%", "genus", "cuts", "status", "seconds");
}

std::string line_of(const FittedSurface& fitted, double diameter) {
  const PointFitSummary& s = fitted.fit.summary;
  return fmt::format("{:>12} {:>6} {:>10.4g} {:>8.4f} {:>10.4g} {:>8.4f} {:>5} {:>6}  {:<16} {:>8.2f}", fitted.name,
                     s.control_points, s.to_surface.rms, 100.0 * s.to_surface.rms / diameter, s.to_surface.max,
                     100.0 * s.to_surface.max / diameter, s.genus, s.self_intersections, to_string(fitted.status),
                     s.seconds);
}

GeometryFitOptions options_of(const GeometryFitSettings& settings) {
  return {.sizes = {.model = settings.model,
                    .detail = settings.detail,
                    .tolerance_mm = settings.tolerance_mm,
                    .tolerance_percent = settings.tolerance_percent,
                    .tolerance_of = settings.tolerance_of,
                    .size = settings.size,
                    .ladder = settings.rungs(),
                    .smoothness = settings.smoothness},
          .mesh_level = settings.mesh_density};
}

GeometryFitResult fit_to_files(const GeometryFitSettings& settings, const RunRecord& record, const Observer& observer) {
  const ThreadLimit limit(settings.threads);
  settings.validate();
  GeometryFitResult result;
  result.settings = settings;
  result.settings.ladder = settings.rungs();
  PhaseClock clock;
  clock.start("read");
  result.file = parse_mask_argument(settings.input).file;
  std::error_code ignored;
  if (!fs::exists(result.file, ignored)) {
    throw NoInput(fmt::format("no such file (`input` {}): nothing is there; check the path", result.file.string()));
  }
  const std::vector<PlannedFile> plan = plan_of(result.settings);
  check_outputs(paths_of(plan), settings.overwrite, {result.file});
  result.input = read_geometry(settings.input, settings.open);
  check_model(settings.model.kind, result.input);
  for (const auto& warning : result.input.warnings) {
    observer.tell_warning(fmt::format("{}: {}", result.file.string(), warning));
  }
  clock.stop();
  result.fit = fit_geometry(result.input, options_of(settings), observer);
  clock.add(result.fit.seconds);
  clock.start("write");
  result.inputs.push_back({to_string(result.input.kind), result.file, sha256_of(result.file)});
  write_outputs(plan, observer, result);
  clock.stop();
  result.seconds = clock.seconds();
  if (settings.writes("report")) write_text_file(path_of(plan, "report"), report_of(result, record).dump(2) + "\n");
  observer.tell_progress(1.0, "done");
  return result;
}

}  // namespace pellicle
