// The report of a morph as JSON: its keys are listed in docs/morph.md.
#include <nlohmann/json.hpp>
#include <numbers>

#include "pellicle/output/morph_files.h"
#include "pellicle/output/report_json.h"

namespace pellicle {
using json = nlohmann::ordered_json;

namespace {

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

json report_of(const MorphResult& result, const RunRecord& record) {
  const MorphSettings& s = result.settings;
  const Morphing& morphing = result.morphing;
  json report = report_head("pellicle-morph", record, result.exit_code());
  report["settings"] = {{"steps", s.steps},     {"space", name_of(s.space)}, {"from", s.from},
                        {"to", s.to},           {"name", stem_of(s)},        {"mesh_format", name_of(s.mesh_format)},
                        {"threads", s.threads}, {"overwrite", s.overwrite}};
  report["settings"]["mesh_density"] = s.mesh_density ? json(*s.mesh_density) : json(nullptr);
  report["inputs"] = inputs_json(result.inputs);
  const SurfaceModel& model = morphing.steps.front().surface.model;
  report["model"] = {{"name", model_name(model)},
                     {"control_points", morphing.points},
                     {"degrees_of_freedom", degrees_of_freedom(model)}};
  const ShapeMoments& m = morphing.moments;
  const auto shape = [](int points, double moved_mm, const Vec3& mean, double size) {
    return json{{"control_points", points},
                {"moved_by_matching_mm", moved_mm},
                {"mean_lps_mm", vector_json(mean)},
                {"size_mm", size}};
  };
  report["a"] = shape(morphing.points_a, morphing.moved_a_mm, m.mean_a, m.size_a);
  report["b"] = shape(morphing.points_b, morphing.moved_b_mm, m.mean_b, m.size_b);
  report["angle_degrees"] = m.angle * 180.0 / std::numbers::pi;
  json steps = json::array();
  for (std::size_t i = 0; i < morphing.steps.size(); ++i) steps.push_back(step_json(i + 1, morphing.steps[i]));
  report["steps"] = steps;
  report["outputs"] = outputs_json(result.outputs);
  add_cost(result.seconds, report);
  return report;
}

}  // namespace pellicle
