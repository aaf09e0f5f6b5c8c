#include "pellicle/pipeline/report.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "pellicle/fit/many.h"
#include "pellicle/pipeline/provenance.h"
#include "pellicle/settings/settings_toml.h"

namespace pellicle {
using json = nlohmann::ordered_json;

namespace {

json json_of(const Vec3& v) {
  return {v[0], v[1], v[2]};
}

// NaN and infinity have no JSON; null says that there is no number.
json number(double value) {
  return std::isfinite(value) ? json(value) : json(nullptr);
}

json weights(const std::map<std::string, double>& values) {
  json object = json::object();
  for (const auto& [name, value] : values) object[name] = number(value);
  return object;
}

json history_json(const std::vector<StepSummary>& history) {
  json steps = json::array();
  for (const auto& step : history) {
    steps.push_back({{"move_mm", number(step.move_mm)}, {"energies", weights(step.energies)}});
  }
  return steps;
}

json stage_json(const StageSummary& s) {
  return {{"name", s.name},
          {"detail", s.detail},
          {"control_points", s.control_points},
          {"degrees_of_freedom", s.degrees_of_freedom},
          {"samples", s.samples},
          {"steps", s.steps},
          {"solver_iterations", s.solver_iterations},
          {"reason", s.reason},
          {"last_move_mm", number(s.last_move_mm)},
          {"rms_residual_mm", number(s.rms_residual_mm)},
          {"energy_before", weights(s.energy_before)},
          {"energy_after", weights(s.energy_after)},
          {"history", history_json(s.history)},
          {"seconds", s.seconds}};
}

json fit_json(const FitSummary& fit) {
  json stages = json::array(), hypotheses = json::array();
  for (const auto& stage : fit.stages) stages.push_back(stage_json(stage));
  for (const auto& h : fit.hypotheses) {
    hypotheses.push_back({{"name", h.name},
                          {"status", to_string(h.status)},
                          {"evidence", number(h.evidence)},
                          {"volume_ml", number(h.volume_ml)},
                          {"chosen", h.chosen}});
  }
  json out;
  out["polarity"] = name_of(fit.polarity);
  out["boundary"] = name_of(fit.boundary);
  out["level_inside"] = number(fit.level_inside);
  out["level_outside"] = number(fit.level_outside);
  out["iterations"] = fit.iterations();
  out["convergence"] = fit.stages.empty() ? json("no stage ran") : json(fit.stages.back().reason);
  out["energy_before"] = fit.stages.empty() ? json::object() : weights(fit.stages.front().energy_before);
  out["energy_after"] = fit.stages.empty() ? json::object() : weights(fit.stages.back().energy_after);
  out["evidence"] = {{"score", number(fit.evidence.score)},
                     {"contrast", number(fit.evidence.contrast)},
                     {"noise", number(fit.evidence.noise)},
                     {"weak_share", number(fit.evidence.weak_share)},
                     {"outside_share", number(fit.evidence.outside_share)}};
  if (fit.points) {
    out["points"] = {
        {"count", fit.points->count}, {"rms_mm", number(fit.points->rms_mm)}, {"max_mm", number(fit.points->max_mm)}};
  }
  if (fit.seed_share) out["seed_share"] = number(*fit.seed_share);
  out["margin"] = fit.margin < 0.0 ? json(nullptr) : number(fit.margin);
  out["stages"] = stages;
  out["hypotheses"] = hypotheses;
  return out;
}

// What is told of each of many objects, see docs/nuclei.md.
json shape_json(const ObjectResult& object) {
  const ObjectShape& shape = *object.shape;
  return {{"centre_lps_mm", json_of(shape.centre)},
          {"sphericity", number(shape.sphericity)},
          {"elongation", number(shape.elongation)},
          {"visible_share", number(shape.visible)},
          {"volume_visible_ml", number(object.volume_partial_ml)},
          {"support", number(shape.support)},
          {"limited_share", number(shape.limited)}};
}

json many_json(const ManySummary& many) {
  return {{"typical_radius_mm", number(many.radius_mm)},
          {"polarity", many.dark ? "dark" : "bright"},
          {"places_tried", many.seeds},
          {"unlike_the_others", many.weak},
          {"doubled", many.doubled},
          {"variation_inside", number(many.variation)},
          {"typical_shape_used", many.typical_shape},
          {"z_to_xy_extent", number(many.z_extent)}};
}

json object_json(const ObjectResult& object) {
  json out;
  out["label"] = object.label;
  out["name"] = object.name;
  out["status"] = to_string(object.fit.status);
  out["reason"] = object.fit.reason;
  out["model"] = {{"name", model_name(object.surface.model)},
                  {"control_points", control_point_count(object.surface.model)},
                  {"degrees_of_freedom", degrees_of_freedom(object.surface.model)}};
  out["volume_ml"] = {{"surface", number(object.volume_surface_ml)},
                      {"mask", object.volume_mask_ml},
                      {"partial_volume", number(object.volume_partial_ml)}};
  const double none = std::numeric_limits<double>::quiet_NaN();
  out["volume_openvdb_ml"] = number(object.volume_openvdb_ml.value_or(none));
  out["volume_mesh_ml"] = number(object.volume_mesh_ml.value_or(none));
  out["area_mm2"] = number(object.area_mm2);
  out["mesh"] = {{"level", object.mesh_level},
                 {"vertices", object.mesh.vertices.size()},
                 {"triangles", object.mesh.triangles.size()}};
  out["watertight"] = object.topology.closed && object.topology.manifold && object.topology.oriented;
  out["genus"] = object.topology.genus;
  out["components"] = object.topology.components;
  out["self_intersections"] = object.self_intersections;
  out["touches_border"] = object.touches_border;
  out["overlap_voxels"] = object.overlap_voxels;
  out["seconds"] = object.seconds;
  if (object.shape) out["shape"] = shape_json(object);
  out["fit"] = fit_json(object.fit);
  return out;
}

json input_json(const SegmentResult& result) {
  json out;
  out["format"] = result.header.format;
  out["component_type"] = result.header.component_type;
  out["grid"] = json_of(result.header.grid);
  out["unit"] = result.header.unit;
  out["spacing_known"] = result.header.spacing_known;
  if (result.frame) {
    out["frame"] = {{"index", *result.frame},
                    {"time", *result.frame * result.header.frame_step},
                    {"unit", result.header.frame_unit}};
  }
  out["min"] = result.min;
  out["max"] = result.max;
  out["nan_count"] = result.nan_count;
  out["inf_count"] = result.inf_count;
  return out;
}

}  // namespace

json json_of(const ImageGrid& grid) {
  json direction = json::array();
  for (int row = 0; row < 3; ++row) direction.push_back(json_of(Vec3(grid.direction.row(row))));
  return {{"size", {grid.size[0], grid.size[1], grid.size[2]}},
          {"spacing_mm", json_of(grid.spacing)},
          {"origin_lps_mm", json_of(grid.origin_in_world)},
          {"direction", direction},
          {"orientation", orientation_code(grid)}};
}

std::string orientation_code(const ImageGrid& grid) {
  // Best assignment of the three axes, not the largest entry of each: near 45 degrees two axes may prefer the same one.
  std::array<int, 3> order{0, 1, 2}, best = order;
  double best_sum = -1.0;
  do {
    double sum = 0.0;
    for (int a = 0; a < 3; ++a) sum += std::abs(grid.direction(order[static_cast<std::size_t>(a)], a));
    if (sum > best_sum + 1e-12) {
      best_sum = sum;
      best = order;
    }
  } while (std::next_permutation(order.begin(), order.end()));
  const std::string positive = "LPS", negative = "RAI";
  std::string code;
  for (int a = 0; a < 3; ++a) {
    const auto axis = static_cast<std::size_t>(best[static_cast<std::size_t>(a)]);
    code += grid.direction(best[static_cast<std::size_t>(a)], a) >= 0.0 ? positive[axis] : negative[axis];
  }
  return code;
}

json report_of(const SegmentResult& result, const RunContext& context) {
  json report;
  report["format"] = "pellicle-report";
  report["version"] = 1;
  json libraries = json::object();
  for (const auto& [name, version] : library_versions()) libraries[name] = version;
  report["program"] = {{"name", "pellicle"}, {"version", program_version()}, {"libraries", libraries}};
  report["command_line"] = context.command_line;
  report["finished"] = utc_time();
  report["exit_code"] = result.exit_code();
  SegmentSettings resolved = result.settings;
  resolved.fit.stages = resolved.wants_many() ? stages_of_many(resolved.fit) : stages_of(resolved.fit);
  report["settings"] = json_of(resolved, context.host_settings);
  if (context.chosen_preset) {
    report["preset_auto"] = {{"chosen", context.chosen_preset->name},
                             {"reason", context.chosen_preset->reason},
                             {"facts", context.chosen_preset->facts}};
  }
  report["input"] = input_json(result);
  json inputs = json::array(), outputs = json::array(), objects = json::array();
  for (const auto& file : result.inputs) {
    inputs.push_back({{"role", file.role}, {"path", file.path.string()}, {"sha256", file.sha256}});
  }
  for (const auto& file : result.outputs) {
    outputs.push_back(
        {{"kind", file.kind}, {"path", file.path.string()}, {"sha256", file.sha256}, {"bytes", file.bytes}});
  }
  for (const auto& object : result.objects) objects.push_back(object_json(object));
  report["inputs"] = inputs;
  if (result.many) report["many"] = many_json(*result.many);
  report["objects"] = objects;
  report["outputs"] = outputs;
  report["warnings"] = result.warnings;
  double total = 0.0;
  json seconds = json::object();
  for (const auto& [phase, time] : result.seconds) {
    seconds[phase] = time;
    total += time;
  }
  seconds["total"] = total;
  report["seconds"] = seconds;
  report["peak_memory_bytes"] = peak_memory_bytes();
  return report;
}

}  // namespace pellicle
