#include "pellicle/settings/geometry_fit_settings.h"

#include <algorithm>
#include <cmath>

#include "pellicle/base/errors.h"
#include "pellicle/settings/setting_fields.h"
#include "pellicle/settings/settings.h"

namespace pellicle {

template <>
const Words<ToleranceOf>& words_of() {
  static const Words<ToleranceOf> all{{ToleranceOf::rms, "rms"}, {ToleranceOf::p95, "p95"}, {ToleranceOf::max, "max"}};
  return all;
}

namespace {

void validate_size(const GeometryFitSettings& s) {
  const bool spline = s.model.kind == ModelKind::spline;
  if ((s.size || !s.ladder.empty()) && !spline)
    throw SettingError("setting without its model", "size, ladder", "they are about splines; give `model` spline");
  const bool by_fit = s.detail || s.tolerance_mm || s.tolerance_percent;
  if (static_cast<int>(s.size.has_value()) + static_cast<int>(!s.ladder.empty()) + static_cast<int>(by_fit) > 1) {
    throw SettingError("conflicting settings", "size, ladder, detail, tolerance-mm, tolerance-percent",
                       "each says how many control points there are; give one");
  }
  if (s.size && ((*s.size)[0] < 4 || (*s.size)[1] < 2 || (*s.size)[0] > 100 || (*s.size)[1] > 100)) {
    refuse_setting("size", fmt::format("{},{}", (*s.size)[0], (*s.size)[1]), "M1 must be 4 to 100 and M2 2 to 100");
  }
  for (const int m : s.ladder) {
    if (m < 4 || m > 100) refuse_setting("ladder", std::to_string(m), "each M must be 4 to 100");
  }
}

void add_model_rows(SettingTable<GeometryFitSettings>& table) {
  table.push_back(setting<GeometryFitSettings>({"Model", "model",
                                                "normal|spline|spline-torus|spline-cylinder|spline-rectangle|"
                                                "catmull-clark|slime",
                                                "surface model"},
                                               SETTING_FIELD(model.kind)));
  table.push_back(setting<GeometryFitSettings>(
      {"Model", "detail", "N",
       "refinements of the start model; spline: the ladder of 10, 20, 40, 80 control points each way for N = 0, 1, 2, "
       "3; with a tolerance: at most; default: until points that are left out of the fit are predicted no better"},
      SETTING_FIELD(detail)));
  table.push_back(setting<GeometryFitSettings>({"Model", "size", "M1,M2", "spline of M1 x M2 control points"},
                                               SETTING_FIELD(size)));
  table.push_back(
      setting<GeometryFitSettings>({"Model", "ladder", "M,M,...",
                                    "spline: one fit of M x M control points for each M, as a table and a picture "
                                    "STEM_ladder.png"},
                                   SETTING_FIELD(ladder)));
  table.push_back(setting<GeometryFitSettings>(
      {"Model", "tolerance-mm", "T", "take the fewest control points whose residual is at most this, mm"},
      SETTING_FIELD(tolerance_mm)));
  table.push_back(setting<GeometryFitSettings>({"Model", "tolerance-percent", "P", "the same in % of the diameter"},
                                               SETTING_FIELD(tolerance_percent)));
  table.push_back(
      setting<GeometryFitSettings>({"Model", "tolerance-of", "rms|p95|max",
                                    "residual (distance from the data to the surface) that the tolerance is about"},
                                   SETTING_FIELD(tolerance_of)));
  table.push_back(setting<GeometryFitSettings>(
      {"Model", "open", "",
       "catmull-clark: the points are those of an open surface, a bowl, cap or tube; it ends "
       "at their rim"},
      SETTING_FIELD(open)));
  table.push_back(setting<GeometryFitSettings>({"Model", "smoothness", "F", "factor of the bending energy"},
                                               SETTING_FIELD(smoothness)));
}

void add_output_rows(SettingTable<GeometryFitSettings>& table) {
  table.push_back(setting<GeometryFitSettings>({.group = "Outputs",
                                                .name = "output",
                                                .placeholder = "DIR",
                                                .help = "output folder, created if missing",
                                                .short_flag = "-o",
                                                .required = true},
                                               SETTING_FIELD(output)));
  table.push_back(setting<GeometryFitSettings>(
      {"Outputs", "name", "STEM", "file stem; default: the input's name without its extensions"}, SETTING_FIELD(name)));
  table.push_back(
      setting<GeometryFitSettings>({"Outputs", "write", "LIST", "of mesh,model,report"}, SETTING_FIELD(write)));
  table.push_back(setting<GeometryFitSettings>(
      {"Outputs", "mesh-format", "ply|stl|obj|vtp|gii", "format of the mesh; coordinates are LPS mm, of gii RAS mm"},
      SETTING_FIELD(mesh_format)));
  table.push_back(setting<GeometryFitSettings>(
      {"Outputs", "mesh-density", "N", "2^N facets along a control edge; default: about 100,000 facets"},
      SETTING_FIELD(mesh_density)));
  table.push_back(
      setting<GeometryFitSettings>({"Outputs", "overwrite", "", "replace files that exist"}, SETTING_FIELD(overwrite)));
  table.push_back(setting<GeometryFitSettings>(
      {"Run", "threads", "N", "threads; 0: all. The results are the same bytes for every N"}, SETTING_FIELD(threads)));
}

}  // namespace

const SettingTable<GeometryFitSettings>& geometry_fit_table() {
  static const SettingTable<GeometryFitSettings> all = [] {
    SettingTable<GeometryFitSettings> table;
    table.push_back(setting<GeometryFitSettings>(
        {.group = "Input",
         .name = "input",
         .placeholder = "FILE",
         .help = "points (.xyz .pts .csv .pcd .ply), mesh (.ply .obj .stl .off .vtp .gii) or mask (.nii.gz ...), "
                 "FILE:LABEL for one label",
         .short_flag = "-i",
         .required = true},
        SETTING_FIELD(input)));
    add_model_rows(table);
    add_output_rows(table);
    return table;
  }();
  return all;
}

bool GeometryFitSettings::writes(const std::string& kind) const {
  return std::find(write.begin(), write.end(), kind) != write.end();
}

std::vector<int> GeometryFitSettings::rungs() const {
  if (model.kind != ModelKind::spline || !detail || tolerance_mm || tolerance_percent) return ladder;
  std::vector<int> sizes;
  for (int k = 0; k <= *detail; ++k) sizes.push_back(SizeOptions::kFirstRung << k);
  return sizes;
}

void GeometryFitSettings::validate() const {
  const bool spline = model.kind == ModelKind::spline;
  const int most_detail = spline ? 3 : 12;
  if (detail && (*detail < 0 || *detail > most_detail)) {
    refuse_setting("detail", std::to_string(*detail),
                   spline ? "must be 0 to 3: splines of 10, 20, 40, 80 points each way" : "must be 0 to 12");
  }
  if (tolerance_mm && !(*tolerance_mm > 0.0))
    refuse_setting("tolerance-mm", fmt::format("{}", *tolerance_mm), "must be positive");
  if (tolerance_percent && !(*tolerance_percent > 0.0))
    refuse_setting("tolerance-percent", fmt::format("{}", *tolerance_percent), "must be positive");
  if (tolerance_mm && tolerance_percent)
    throw SettingError("conflicting settings", "tolerance-mm, tolerance-percent", "give one of them");
  if (!(smoothness > 0.0 && std::isfinite(smoothness)))
    refuse_setting("smoothness", fmt::format("{}", smoothness), "must be positive");
  if (mesh_density && (*mesh_density < 0 || *mesh_density > 7))
    refuse_setting("mesh-density", std::to_string(*mesh_density), "must be 0 to 7 (2^N facets along a control edge)");
  if (open && model.kind != ModelKind::catmull_clark)
    throw SettingError("setting without its model", "open", "surfaces with a rim are fitted by `model` catmull-clark");
  validate_size(*this);
  for (const std::string& kind : write) {
    if (kind != "mesh" && kind != "model" && kind != "report")
      refuse_setting("write", kind, "choose from mesh, model, report");
  }
  if (write.empty())
    throw SettingError("bad value", "write", "nothing is to be written; choose from mesh, model, report");
  if (threads < 0) refuse_setting("threads", std::to_string(threads), "must be 0 (all) or more");
}

}  // namespace pellicle
