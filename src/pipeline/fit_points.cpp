#include "pellicle/pipeline/fit_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "pellicle/base/atomic_file.h"
#include "pellicle/base/errors.h"
#include "pellicle/base/interrupt.h"
#include "pellicle/base/parallel.h"
#include "pellicle/pipeline/fit_report.h"
#include "pellicle/pipeline/outputs.h"
#include "pellicle/pipeline/provenance.h"
#include "pellicle/pipeline/seeding.h"
#include "pellicle/surface/model_file.h"

namespace pellicle {
namespace fs = std::filesystem;

namespace {

constexpr int kMostPointsByItself = 700;  ///< control points that a fit takes without being told to
constexpr int kMostPointsForTolerance = 2600;
constexpr double kWorthwhile = 0.9;  ///< a finer level must bring the left-out points down to this share

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

double residual_for(const PointFit& fit, ToleranceOf which) {
  const Residual& r = fit.summary.to_surface;
  return which == ToleranceOf::rms ? r.rms : which == ToleranceOf::p95 ? r.p95 : r.max;
}

std::string name_of_model(const SurfaceModel& model) {
  if (const auto* spline = std::get_if<SplineModel>(&model))
    return fmt::format("{} x {}", spline->settings().m1, spline->settings().m2);
  return fmt::format("{} points", control_point_count(model));
}

SurfaceModel refined(const SurfaceModel& model) {
  return refine(Surface{model, affine_image(model, Vec3::Zero(), Mat3::Identity())}).model;
}

/// Fits levels one after the other, as the settings ask.
class Fitter {
 public:
  Fitter(const GeometryFitSettings& settings, const RunContext& context, GeometryFitResult& result)
      : settings_(settings), context_(context), result_(result), data_(result.input.data) {
    if (settings.tolerance_mm) tolerance_ = *settings.tolerance_mm;
    if (settings.tolerance_percent) tolerance_ = 0.01 * *settings.tolerance_percent * data_.diameter;
    fit_settings_.smoothness = settings.smoothness;
  }

  void run() {
    if (result_.input.grid) {
      interpolate();
    } else {
      lay_out();
      if (!settings_.ladder.empty()) {
        for (const int m : settings_.ladder) keep(one(sized(m, m), false));
        result_.chosen = result_.tried.size() - 1;
      } else if (settings_.size) {
        keep(one(sized((*settings_.size)[0], (*settings_.size)[1]), false));
      } else if (tolerance_) {
        until_tolerance();
      } else if (settings_.detail) {
        keep(one(at_detail(*settings_.detail), false));
      } else {
        by_left_out_points();
      }
    }
    for (FittedSurface& fitted : result_.tried) judge(fitted);
  }

 private:
  void interpolate() {
    const SplineTopology topology =
        settings_.model.kind == ModelKind::spline_torus ? SplineTopology::torus : SplineTopology::sphere;
    PointFit fit{interpolate_grid(*result_.input.grid, topology), {}};
    fit.summary.control_points = control_point_count(fit.surface.model);
    fit.summary.degrees_of_freedom = degrees_of_freedom(fit.surface.model);
    fit.summary.reason = "interpolated";
    measure_fit(data_, fit);
    keep(std::move(fit));
  }

  void lay_out() {
    tell(0.1, "laying the surface out on a sphere");
    SphereMapSettings map_settings;
    const SphereMap map = map_to_sphere(result_.input.solid, map_settings);
    result_.stretch = map.stretch;
    SurfaceModel probe = start_model(settings_.model);
    while (control_point_count(probe) < 60) probe = refined(probe);
    tell(0.15, "choosing the axis");
    correspondence_ = choose_axis(map, probe);
  }

  SurfaceModel sized(int m1, int m2) const {
    SplineSettings spline;
    spline.m1 = m1;
    spline.m2 = m2;
    return SplineModel(spline);
  }

  SurfaceModel at_detail(int detail) const {
    SurfaceModel model = start_model(settings_.model);
    for (int k = 0; k < detail; ++k) model = refined(model);
    return model;
  }

  void tell(double share, const std::string& what) const {
    if (context_.inform) context_.inform(what);
    if (context_.progress) context_.progress(share, what);
    check_interrupt();
  }

  PointFit one(const SurfaceModel& model, bool hold_out) {
    tell(std::min(0.8, 0.2 + 0.1 * static_cast<double>(result_.tried.size())), "fitting " + name_of_model(model));
    PointFit fit = fit_to_map(model, data_, *correspondence_, fit_settings_, hold_out);
    measure_fit(data_, fit);
    return fit;
  }

  void keep(PointFit fit) {
    std::string name = name_of_model(fit.surface.model);
    result_.tried.push_back({std::move(name), std::move(fit), "", ""});
  }

  void until_tolerance() {
    SurfaceModel model = start_model(settings_.model);
    std::size_t best = 0;
    for (int detail = 0;; ++detail, model = refined(model)) {
      if (settings_.detail ? detail > *settings_.detail : control_point_count(model) > kMostPointsForTolerance) break;
      keep(one(model, false));
      const double here = residual_for(result_.tried.back().fit, settings_.tolerance_of);
      if (here < residual_for(result_.tried[best].fit, settings_.tolerance_of)) best = result_.tried.size() - 1;
      if (here <= *tolerance_) break;
    }
    result_.chosen = best;
  }

  void by_left_out_points() {
    SurfaceModel model = start_model(settings_.model), chosen = model;
    double best = -1.0;
    const int most = std::min<int>(kMostPointsByItself, std::max<int>(10, static_cast<int>(data_.points.size() / 3)));
    for (int poor = 0; poor < 2 && control_point_count(model) <= most; model = refined(model)) {
      const PointFit fit = one(model, true);
      const bool better = best < 0.0 || fit.summary.held_out_rms < kWorthwhile * best;
      poor = better ? 0 : poor + 1;
      if (better) {
        best = fit.summary.held_out_rms;
        chosen = model;
      }
      if (best < 1e-6 * data_.diameter) break;
    }
    PointFit final_fit = one(chosen, false);
    final_fit.summary.held_out_rms = best;
    keep(std::move(final_fit));
  }

  void judge(FittedSurface& fitted) const {
    fitted.status = "ok";
    fitted.reason = fitted.fit.summary.reason;
    if (tolerance_ && residual_for(fitted.fit, settings_.tolerance_of) > *tolerance_) {
      fitted.status = "tolerance_missed";
      fitted.reason = fmt::format("the residual is {:.4g} mm, {:.4g} mm were asked for",
                                  residual_for(fitted.fit, settings_.tolerance_of), *tolerance_);
    }
    if (fitted.fit.summary.self_intersections > 0) {
      fitted.status = "folded";
      fitted.reason = fmt::format("the surface cuts itself: {} pairs of facets", fitted.fit.summary.self_intersections);
    }
  }

  const GeometryFitSettings& settings_;
  const RunContext& context_;
  GeometryFitResult& result_;
  const GeometryData& data_;
  std::optional<double> tolerance_;
  PointFitSettings fit_settings_;
  std::optional<Correspondence> correspondence_;
};

int density_for(const Surface& surface) {
  int level = 6;
  while (level > 2 && base_facets(surface.model) * std::pow(4.0, level) > 120000.0) --level;
  return level;
}

void measure_mesh(GeometryFitResult& result) {
  const Surface& surface = result.tried[result.chosen].fit.surface;
  result.mesh = tessellate(surface, result.settings.mesh_density.value_or(density_for(surface)));
  for (const Vec3& v : result.mesh.vertices) {
    if (!v.allFinite()) throw Error(1, "fit failed (surface): it is not finite; please report this");
  }
  if (volume_of(result.mesh) < 0.0) {
    for (auto& t : result.mesh.triangles) std::swap(t[1], t[2]);
    for (Vec3& n : result.mesh.normals) n = -n;
  }
  result.topology = topology_of(result.mesh);
  result.volume_ml = std::abs(volume_with_normals(tessellate(surface, density_for(surface)))) / 1000.0;
  result.area_mm2 = area_of(result.mesh);
}

void write_outputs(const std::vector<PlannedFile>& plan, GeometryFitResult& result) {
  const GeometryFitSettings& settings = result.settings;
  create_folder(settings.output);
  if (settings.writes("mesh")) write_mesh(path_of(plan, "mesh"), result.mesh, settings.mesh_format);
  if (settings.writes("model")) write_model(path_of(plan, "model"), result.tried[result.chosen].fit.surface);
  if (!settings.ladder.empty()) write_ladder_picture(path_of(plan, "ladder"), result);
  check_interrupt();
  for (const auto& file : plan) {
    if (file.kind != "report")
      result.outputs.push_back({file.kind, file.path, sha256_of(file.path), fs::file_size(file.path)});
  }
}

}  // namespace

bool GeometryFitSettings::writes(const std::string& kind) const {
  return std::find(write.begin(), write.end(), kind) != write.end();
}

void GeometryFitSettings::validate() const {
  const auto refuse = [](const std::string& flag, const std::string& value, const std::string& rule) {
    throw UsageError(fmt::format("bad value (--{} {}): {}", flag, value, rule));
  };
  const bool spline = model.kind == ModelKind::spline;
  if (detail && (*detail < 0 || *detail > 12)) refuse("detail", std::to_string(*detail), "must be 0 to 12");
  if (tolerance_mm && !(*tolerance_mm > 0.0))
    refuse("tolerance-mm", fmt::format("{}", *tolerance_mm), "must be positive");
  if (tolerance_percent && !(*tolerance_percent > 0.0))
    refuse("tolerance-percent", fmt::format("{}", *tolerance_percent), "must be positive");
  if (tolerance_mm && tolerance_percent)
    throw UsageError("conflicting flags (--tolerance-mm, --tolerance-percent): give one of them");
  if (!(smoothness > 0.0 && std::isfinite(smoothness)))
    refuse("smoothness", fmt::format("{}", smoothness), "must be positive");
  if (mesh_density && (*mesh_density < 0 || *mesh_density > 7))
    refuse("mesh-density", std::to_string(*mesh_density), "must be 0 to 7 (2^N facets along a control edge)");
  if ((size || !ladder.empty()) && !spline)
    throw UsageError("flag without its model (--size, --ladder): they are about splines; give --model spline");
  if ((size ? 1 : 0) + (ladder.empty() ? 0 : 1) + (detail || tolerance_mm || tolerance_percent ? 1 : 0) > 1) {
    throw UsageError(
        "conflicting flags (--size, --ladder, --detail or a tolerance): each says how many control points there are; "
        "give one");
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
  if (write.empty()) throw UsageError("bad value (--write): nothing is to be written; choose from mesh, model, report");
  if (threads < 0) refuse("threads", std::to_string(threads), "must be 0 (all) or more");
}

int GeometryFitResult::exit_code() const {
  if (!settings.ladder.empty()) {
    return std::all_of(tried.begin(), tried.end(), [](const FittedSurface& f) { return f.status == "ok"; }) ? 0 : 3;
  }
  return tried[chosen].status == "ok" ? 0 : 3;
}

std::string heading_of_fits() {
  return fmt::format("{:>12} {:>6} {:>10} {:>8} {:>10} {:>8} {:>6}  {:<16} {:>8}", "size", "points", "rms_mm", "rms_%",
                     "max_mm", "max_%", "cuts", "status", "seconds");
}

std::string line_of(const FittedSurface& fitted, double diameter) {
  const PointFitSummary& s = fitted.fit.summary;
  return fmt::format("{:>12} {:>6} {:>10.4g} {:>8.4f} {:>10.4g} {:>8.4f} {:>6}  {:<16} {:>8.2f}", fitted.name,
                     s.control_points, s.to_surface.rms, 100.0 * s.to_surface.rms / diameter, s.to_surface.max,
                     100.0 * s.to_surface.max / diameter, s.self_intersections, fitted.status, s.seconds);
}

Surface interpolate_grid(const PointGrid& grid, SplineTopology topology) {
  const bool sphere = topology == SplineTopology::sphere;
  const int m1 = grid.columns, m2 = sphere ? grid.rows - 1 : grid.rows;
  if (m1 < 4 || m2 < (sphere ? 2 : 4)) {
    throw BadData(fmt::format("grid of points (u_index, v_index): {} x {} is too small; a {} takes 4 x {} or more",
                              grid.columns, grid.rows, to_string(topology), sphere ? 3 : 4));
  }
  SplineSettings settings;
  settings.topology = topology;
  settings.m1 = m1;
  settings.m2 = m2;
  const SplineModel model(settings);
  Parameters parameters;
  const auto add = [&](const Vec3& x) { parameters.insert(parameters.end(), {x.x(), x.y(), x.z()}); };
  if (!sphere) {
    for (const Vec3& x : grid.points) add(x);
    return {model, parameters};
  }
  const double extent = diameter_of(grid.points);
  for (const int pole : {0, m2}) {
    for (int k = 1; k < m1; ++k) {
      if ((grid.at(k, pole) - grid.at(0, pole)).norm() > 1e-6 * extent) {
        throw BadData(fmt::format(
            "grid of points (v_index {}): the row of a pole must hold one point, {} of them differ", pole, k));
      }
    }
    add(grid.at(0, pole));
  }
  // First harmonic of the row next to the pole; on a sphere it is R sin(pi/M2) and the tangent pi R.
  const auto tangents = [&](int row, double sign) {
    const double factor = sign * std::numbers::pi / std::sin(std::numbers::pi / m2) * 2.0 / m1;
    Vec3 a = Vec3::Zero(), b = Vec3::Zero();
    for (int k = 0; k < m1; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / m1;
      a += std::cos(angle) * grid.at(k, row);
      b += std::sin(angle) * grid.at(k, row);
    }
    add(factor * a);
    add(factor * b);
  };
  tangents(1, 1.0);
  tangents(m2 - 1, -1.0);
  for (int l = 1; l < m2; ++l) {
    for (int k = 0; k < m1; ++k) add(grid.at(k, l));
  }
  return {model, parameters};
}

GeometryFitResult fit_geometry(const GeometryFitSettings& settings, const RunContext& context) {
  const ThreadLimit limit(settings.threads);
  settings.validate();
  GeometryFitResult result;
  result.settings = settings;
  PhaseClock clock;
  clock.start("read");
  const fs::path file = parse_mask_argument(settings.input).file;
  std::error_code ignored;
  if (!fs::exists(file, ignored)) {
    throw NoInput(fmt::format("no such file (-i {}): nothing is there; check the path", file.string()));
  }
  const std::vector<PlannedFile> plan = plan_of(settings);
  std::vector<fs::path> paths;
  paths.reserve(plan.size());
  for (const auto& planned : plan) paths.push_back(planned.path);
  check_outputs(paths, settings.overwrite, {file});
  result.input = read_geometry(settings.input);
  if (result.input.grid && settings.model.kind != ModelKind::spline && settings.model.kind != ModelKind::spline_torus) {
    throw UsageError(fmt::format(
        "bad value (--model {}): a grid of points (u_index, v_index) is interpolated by a spline; give --model spline",
        name_of(settings.model.kind)));
  }
  if (!result.input.grid && settings.model.kind != ModelKind::normal && settings.model.kind != ModelKind::spline) {
    throw UsageError(fmt::format("bad value (--model {}): geometry without a grid is fitted by normal and spline",
                                 name_of(settings.model.kind)));
  }
  for (const auto& warning : result.input.warnings) {
    if (context.warn) context.warn(fmt::format("{}: {}", file.string(), warning));
  }
  clock.start("fit");
  Fitter(settings, context, result).run();
  clock.start("measure");
  measure_mesh(result);
  clock.start("write");
  result.inputs.push_back({result.input.kind, file, sha256_of(file)});
  write_outputs(plan, result);
  clock.stop();
  result.seconds = clock.seconds();
  if (settings.writes("report"))
    write_text_file(path_of(plan, "report"), report_of(result, context.command_line).dump(2) + "\n");
  if (context.progress) context.progress(1.0, "done");
  return result;
}

}  // namespace pellicle
