#include "pellicle/output/segment_report.h"

#include <nlohmann/json.hpp>

#include "pellicle/fit/many/many.h"
#include "pellicle/output/report_json.h"
#include "pellicle/settings/settings_toml.h"

namespace pellicle {
using json = nlohmann::ordered_json;

namespace {

json weights(const std::map<std::string, double>& values) {
  json object = json::object();
  for (const auto& [name, value] : values) object[name] = number_json(value);
  return object;
}

json history_json(const std::vector<StepSummary>& history) {
  json steps = json::array();
  for (const auto& step : history) {
    steps.push_back({{"move_mm", number_json(step.move_mm)}, {"energies", weights(step.energies)}});
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
          {"reason", s.reason()},
          {"last_move_mm", number_json(s.last_move_mm)},
          {"rms_residual_mm", number_json(s.rms_residual_mm)},
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
                          {"evidence", number_json(h.evidence)},
                          {"volume_ml", number_json(h.volume_ml)},
                          {"chosen", h.chosen}});
  }
  json out;
  out["polarity"] = name_of(fit.polarity);
  out["boundary"] = name_of(fit.boundary);
  out["level_inside"] = number_json(fit.level_inside);
  out["level_outside"] = number_json(fit.level_outside);
  out["iterations"] = fit.iterations();
  out["convergence"] = fit.stages.empty() ? json("no stage ran") : json(fit.stages.back().reason());
  out["energy_before"] = fit.stages.empty() ? json::object() : weights(fit.stages.front().energy_before);
  out["energy_after"] = fit.stages.empty() ? json::object() : weights(fit.stages.back().energy_after);
  out["evidence"] = {{"score", number_json(fit.evidence.score)},
                     {"contrast", number_json(fit.evidence.contrast)},
                     {"noise", number_json(fit.evidence.noise)},
                     {"weak_share", number_json(fit.evidence.weak_share)},
                     {"outside_share", number_json(fit.evidence.outside_share)}};
  if (fit.points) {
    out["points"] = {{"count", fit.points->count},
                     {"rms_mm", number_json(fit.points->rms_mm)},
                     {"max_mm", number_json(fit.points->max_mm)}};
  }
  if (fit.seed_share) out["seed_share"] = number_json(*fit.seed_share);
  out["margin"] = fit.margin < 0.0 ? json(nullptr) : number_json(fit.margin);
  out["stages"] = stages;
  out["hypotheses"] = hypotheses;
  return out;
}

// The figures of each of many objects, see docs/nuclei.md.
json shape_json(const ObjectResult& object) {
  const ObjectShape& shape = *object.shape;
  return {{"centre_lps_mm", vector_json(shape.centre)},
          {"sphericity", number_json(shape.sphericity)},
          {"elongation", number_json(shape.elongation)},
          {"visible_share", number_json(shape.visible)},
          {"volume_visible_ml", number_json(object.volume_partial_ml)},
          {"support", number_json(shape.support)},
          {"limited_share", number_json(shape.limited)}};
}

json many_json(const ManySummary& many) {
  return {{"typical_radius_mm", number_json(many.radius_mm)},
          {"polarity", many.dark ? "dark" : "bright"},
          {"places_tried", many.seeds},
          {"unlike_the_others", many.weak},
          {"doubled", many.doubled},
          {"variation_inside", number_json(many.variation)},
          {"typical_shape_used", many.typical_shape},
          {"z_to_xy_extent", number_json(many.z_extent)}};
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
  out["volume_ml"] = {{"surface", number_json(object.volume_surface_ml)},
                      {"mask", object.volume_mask_ml},
                      {"partial_volume", number_json(object.volume_partial_ml)}};
  out["volume_openvdb_ml"] = number_json(object.volume_openvdb_ml);
  out["volume_mesh_ml"] = number_json(object.volume_mesh_ml);
  out["area_mm2"] = number_json(object.area_mm2);
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

json report_of(const SegmentResult& result, const RunRecord& record) {
  json report = report_head("pellicle-report", record, result.exit_code());
  SegmentSettings resolved = result.settings;
  resolved.fit.stages = plan_of(resolved).first.stages;
  report["settings"] = json_of(resolved, record.host_settings);
  if (record.chosen_preset) {
    report["preset_auto"] = {{"chosen", record.chosen_preset->name},
                             {"reason", record.chosen_preset->reason},
                             {"facts", record.chosen_preset->facts}};
  }
  report["input"] = input_json(result);
  report["inputs"] = inputs_json(result.inputs);
  if (result.segmentation.many) report["many"] = many_json(*result.segmentation.many);
  json objects = json::array();
  for (const auto& object : result.segmentation.objects) objects.push_back(object_json(object));
  report["objects"] = objects;
  report["outputs"] = outputs_json(result.outputs);
  report["warnings"] = result.warnings;
  add_cost(result.seconds, report);
  return report;
}

}  // namespace pellicle
