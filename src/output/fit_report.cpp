#include "pellicle/output/fit_report.h"

#include <nlohmann/json.hpp>

#include "pellicle/output/report_json.h"
#include "pellicle/picture/line_plot.h"
#include "pellicle/settings/settings.h"

namespace pellicle {
using json = nlohmann::ordered_json;

namespace {

json residual_json(const Residual& r, double diameter) {
  const double percent = diameter > 0.0 ? 100.0 / diameter : 0.0;
  return {{"rms_mm", number_json(r.rms)},
          {"p95_mm", number_json(r.p95)},
          {"max_mm", number_json(r.max)},
          {"rms_percent", number_json(percent * r.rms)},
          {"p95_percent", number_json(percent * r.p95)},
          {"max_percent", number_json(percent * r.max)}};
}

json fit_json(const FittedSurface& fitted, double diameter) {
  const PointFitSummary& s = fitted.fit.summary;
  json out;
  out["name"] = fitted.name;
  out["status"] = to_string(fitted.status);
  out["reason"] = fitted.reason;
  out["convergence"] = s.reason;
  out["model"] = {{"name", model_name(fitted.fit.surface.model)},
                  {"control_points", s.control_points},
                  {"degrees_of_freedom", s.degrees_of_freedom}};
  out["data_to_surface"] = residual_json(s.to_surface, diameter);
  out["surface_to_data"] = residual_json(s.to_data, diameter);
  out["held_out_rms_mm"] = s.held_out_rms >= 0.0 ? number_json(s.held_out_rms) : json(nullptr);
  out["inlier_rms_mm"] = number_json(s.inlier_rms);
  out["astray_share"] = number_json(s.astray_share);
  out["self_intersections"] = s.self_intersections;
  out["genus"] = s.genus;
  out["border_loops"] = s.border_loops;
  out["steps"] = s.steps;
  out["solver_iterations"] = s.solver_iterations;
  out["seconds"] = s.seconds;
  return out;
}

const char* name_of_tolerance(ToleranceOf value) {
  return value == ToleranceOf::rms ? "rms" : value == ToleranceOf::p95 ? "p95" : "max";
}

json settings_json(const GeometryFitSettings& s) {
  json out;
  out["input"] = s.input;
  out["output"] = s.output.string();
  out["name"] = s.name;
  out["model"] = name_of(s.model.kind);
  out["detail"] = s.detail ? json(*s.detail) : json(nullptr);
  out["tolerance-mm"] = s.tolerance_mm ? json(*s.tolerance_mm) : json(nullptr);
  out["tolerance-percent"] = s.tolerance_percent ? json(*s.tolerance_percent) : json(nullptr);
  out["tolerance-of"] = name_of_tolerance(s.tolerance_of);
  out["size"] = s.size ? json({(*s.size)[0], (*s.size)[1]}) : json(nullptr);
  out["ladder"] = s.ladder;
  out["open"] = s.open;
  out["smoothness"] = s.smoothness;
  out["write"] = s.write;
  out["mesh-format"] = name_of(s.mesh_format);
  out["mesh-density"] = s.mesh_density ? json(*s.mesh_density) : json(nullptr);
  out["threads"] = s.threads;
  out["overwrite"] = s.overwrite;
  return out;
}

}  // namespace

json report_of(const GeometryFitResult& result, const RunRecord& record) {
  json report = report_head("pellicle-fit-report", record, result.exit_code());
  report["settings"] = settings_json(result.settings);
  const GeometryData& data = result.input.data;
  int rim_points = 0;
  for (const RimCurve& rim : data.rim) rim_points += rim.points;
  report["input"] = {
      {"kind", to_string(result.input.kind)},
      {"points", data.points.size()},
      {"closed_surface", data.surface.has_value()},
      {"genus", result.input.genus},
      {"rim_points", rim_points},
      {"diameter_mm", number_json(data.diameter)},
      {"bridged_mm", number_json(result.input.bridged_mm)},
      {"spherical_stretch", result.fit.sizes.stretch > 0.0 ? number_json(result.fit.sizes.stretch) : json(nullptr)}};
  const FittedSurface& chosen = result.fit.sizes.best();
  json object = fit_json(chosen, data.diameter);
  object["volume_ml"] = number_json(result.fit.volume_ml);
  object["area_mm2"] = number_json(result.fit.area_mm2);
  object["mesh"] = {{"vertices", result.fit.mesh.vertices.size()}, {"triangles", result.fit.mesh.triangles.size()}};
  object["watertight"] = result.fit.topology.closed && result.fit.topology.manifold && result.fit.topology.oriented;
  object["components"] = result.fit.topology.components;
  report["object"] = object;
  json tried = json::array();
  for (const auto& fitted : result.fit.sizes.tried) tried.push_back(fit_json(fitted, data.diameter));
  report["levels"] = tried;
  report["inputs"] = inputs_json(result.inputs);
  report["outputs"] = outputs_json(result.outputs);
  std::vector<std::string> warnings = result.input.warnings;
  warnings.insert(warnings.end(), result.fit.sizes.warnings.begin(), result.fit.sizes.warnings.end());
  report["warnings"] = warnings;
  add_cost(result.seconds, report);
  return report;
}

Canvas ladder_picture(const GeometryFitResult& result) {
  LinePlot plot{"residual of " + result.file.filename().string(), "control points", "% of the diameter", {}};
  plot.curves = {{"max", {214, 96, 77}, {}}, {"95th percentile", {230, 171, 60}, {}}, {"rms", {67, 147, 195}, {}}};
  const double percent = 100.0 / result.input.data.diameter;
  for (const auto& fitted : result.fit.sizes.tried) {
    const PointFitSummary& s = fitted.fit.summary;
    const double x = s.control_points;
    plot.curves[0].points.emplace_back(x, percent * s.to_surface.max);
    plot.curves[1].points.emplace_back(x, percent * s.to_surface.p95);
    plot.curves[2].points.emplace_back(x, percent * s.to_surface.rms);
  }
  return draw_line_plot(plot, 900, 640);
}

}  // namespace pellicle
