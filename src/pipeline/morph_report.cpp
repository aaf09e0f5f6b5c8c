// The report of a morph as JSON: its keys are listed in docs/morph.md.
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "pellicle/pipeline/morph.h"
#include "pellicle/pipeline/provenance.h"

namespace pellicle {
using json = nlohmann::ordered_json;

namespace {

json vector_json(const Vec3& v) {
  return {v[0], v[1], v[2]};
}

json step_json(std::size_t number, const MorphStep& step) {
  json out;
  out["step"] = number;
  out["tau"] = step.tau;
  out["status"] = to_string(step.status);
  out["volume_ml"] = step.volume_ml ? json(*step.volume_ml) : json(nullptr);
  out["area_mm2"] = step.area_mm2;
  out["self_intersections"] = step.self_intersections;
  out["watertight"] = step.watertight;
  out["genus"] = step.watertight ? json(step.genus) : json(nullptr);
  return out;
}

}  // namespace

json report_of(const MorphResult& result, const std::vector<std::string>& command_line) {
  const MorphSettings& s = result.settings;
  json report;
  report["format"] = "pellicle-morph";
  report["version"] = 1;
  json libraries = json::object();
  for (const auto& [name, version] : library_versions()) libraries[name] = version;
  report["program"] = {{"name", "pellicle"}, {"version", program_version()}, {"libraries", libraries}};
  report["command_line"] = command_line;
  report["finished"] = utc_time();
  report["exit_code"] = result.exit_code();
  report["settings"] = {{"steps", s.steps},     {"space", name_of(s.space)}, {"from", s.from},
                        {"to", s.to},           {"name", stem_of(s)},        {"mesh_format", name_of(s.mesh_format)},
                        {"threads", s.threads}, {"overwrite", s.overwrite}};
  report["settings"]["mesh_density"] = s.mesh_density ? json(*s.mesh_density) : json(nullptr);
  json inputs = json::array(), outputs = json::array(), steps = json::array();
  for (const auto& file : result.inputs) {
    inputs.push_back({{"role", file.role}, {"path", file.path.string()}, {"sha256", file.sha256}});
  }
  for (const auto& file : result.outputs) {
    outputs.push_back(
        {{"kind", file.kind}, {"path", file.path.string()}, {"sha256", file.sha256}, {"bytes", file.bytes}});
  }
  for (std::size_t i = 0; i < result.steps.size(); ++i) steps.push_back(step_json(i + 1, result.steps[i]));
  const SurfaceModel& model = result.steps.front().surface.model;
  report["inputs"] = inputs;
  report["model"] = {{"name", model_name(model)},
                     {"control_points", result.points},
                     {"degrees_of_freedom", degrees_of_freedom(model)}};
  const ShapeMoments& m = result.moments;
  const auto shape = [](int points, double moved_mm, const Vec3& mean, double size) {
    return json{{"control_points", points},
                {"moved_by_matching_mm", moved_mm},
                {"mean_lps_mm", vector_json(mean)},
                {"size_mm", size}};
  };
  report["a"] = shape(result.points_a, result.moved_a_mm, m.mean_a, m.size_a);
  report["b"] = shape(result.points_b, result.moved_b_mm, m.mean_b, m.size_b);
  report["angle_degrees"] = m.angle * 180.0 / std::numbers::pi;
  report["steps"] = steps;
  report["outputs"] = outputs;
  json seconds = json::object();
  double total = 0.0;
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
