#include "pellicle/settings/morph_settings.h"

#include <cmath>
#include <utility>

#include "pellicle/base/errors.h"
#include "pellicle/settings/setting_fields.h"
#include "pellicle/settings/settings.h"

namespace pellicle {

template <>
const Words<MorphSpace>& words_of() {
  static const Words<MorphSpace> all{{MorphSpace::plane, "plane"}, {MorphSpace::sphere, "sphere"}};
  return all;
}

namespace {

constexpr int kMostSteps = 1000;
constexpr double kFarthestTau = 100.0;

void add_path_rows(SettingTable<MorphSettings>& table) {
  table.push_back(setting<MorphSettings>({.group = "Input",
                                          .name = "a",
                                          .placeholder = "A.json",
                                          .help = "a saved model, STEM_model.json: tau = 0",
                                          .argument = true,
                                          .required = true},
                                         SETTING_FIELD(a)));
  table.push_back(setting<MorphSettings>({.group = "Input",
                                          .name = "b",
                                          .placeholder = "B.json",
                                          .help = "another of the same kind: tau = 1",
                                          .argument = true,
                                          .required = true},
                                         SETTING_FIELD(b)));
  table.push_back(setting<MorphSettings>({"Path", "steps", "N", "shapes, equally spaced in tau; 1: the middle"},
                                         SETTING_FIELD(steps)));
  table.push_back(setting<MorphSettings>(
      {"Path", "space", "plane|sphere", "plane: linear; sphere: the great circle of shapes, size and place apart"},
      SETTING_FIELD(space)));
  table.push_back(setting<MorphSettings>(
      {"Path", "from", "T0", "tau of the first shape; below 0 or above 1 extrapolates"}, SETTING_FIELD(from)));
  table.push_back(setting<MorphSettings>({"Path", "to", "T1", "tau of the last shape"}, SETTING_FIELD(to)));
}

void add_output_rows(SettingTable<MorphSettings>& table) {
  table.push_back(setting<MorphSettings>({.group = "Outputs",
                                          .name = "output",
                                          .placeholder = "DIR",
                                          .help = "output folder, created if missing",
                                          .short_flag = "-o",
                                          .required = true},
                                         SETTING_FIELD(output)));
  table.push_back(setting<MorphSettings>(
      {"Outputs", "name", "STEM", "file stem; default: A_to_B, by the names of the models"}, SETTING_FIELD(name)));
  table.push_back(setting<MorphSettings>({"Outputs", "mesh-format", "ply|stl|obj|vtp|gii", "LPS mm; gii: RAS mm"},
                                         SETTING_FIELD(mesh_format)));
  table.push_back(setting<MorphSettings>(
      {"Outputs", "mesh-density", "N", "2^N facets along a control edge; default: about 300 facets around the object"},
      SETTING_FIELD(mesh_density)));
  table.push_back(
      setting<MorphSettings>({"Outputs", "overwrite", "", "replace files that exist"}, SETTING_FIELD(overwrite)));
  table.push_back(setting<MorphSettings>({"Run", "threads", "N", "threads; 0: all"}, SETTING_FIELD(threads)));
}

}  // namespace

const SettingTable<MorphSettings>& morph_table() {
  static const SettingTable<MorphSettings> all = [] {
    SettingTable<MorphSettings> table;
    add_path_rows(table);
    add_output_rows(table);
    return table;
  }();
  return all;
}

void MorphSettings::validate() const {
  const auto require = [](bool ok, const std::string& key, const auto& value, const std::string& rule) {
    if (!ok) throw SettingError("bad value", key, fmt::format("{}", value), rule);
  };
  require(steps >= 1 && steps <= kMostSteps, "steps", steps, fmt::format("must lie between 1 and {}", kMostSteps));
  for (const auto& [key, tau] : {std::pair{"from", from}, std::pair{"to", to}}) {
    require(std::abs(tau) <= kFarthestTau, key, tau,
            fmt::format("must lie between -{0} and {0}; A is 0, B is 1", kFarthestTau));
  }
  require(steps == 1 || from != to, "to", to,
          "is the same as `from`, all steps would be one; change one of them or give `steps` 1");
  require(!mesh_density || (*mesh_density >= 0 && *mesh_density <= 7), "mesh-density", mesh_density.value_or(0),
          "must lie between 0 and 7");
  require(threads >= 0, "threads", threads, "must be 0 (all) or more");
  require(name.find('/') == std::string::npos, "name", name, "must be a file stem without folders");
}

}  // namespace pellicle
