#include "pellicle/settings/settings_toml.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "pellicle/base/errors.h"
#include "pellicle/energies/energy_kinds.h"
#include "pellicle/settings/internal/toml_reading.h"
#include "pellicle/settings/setting_words.h"
#include "pellicle/settings/toml_settings.h"

namespace pellicle {

namespace {

Stage stage_of(const toml::table& table, const std::string& origin) {
  Stage stage;
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    const std::string where = place_of(origin, node, fmt::format("stage.{}", name));
    const auto integer = [&, &value = node] { return integer_of(scalar_text(value, where), where); };
    const auto number = [&, &value = node] { return number_of(scalar_text(value, where), where); };
    if (name == "name") {
      stage.name = scalar_text(node, where);
    } else if (name == "detail") {
      stage.detail = integer();
    } else if (name == "max_steps") {
      stage.max_steps = integer();
    } else if (name == "resolution") {
      stage.resolution = number();
    } else if (name == "smoothing") {
      stage.smoothing = number();
    } else if (name == "smoothing_mm") {
      stage.smoothing_mm = number();
    } else if (name == "reach") {
      stage.reach = number();
    } else if (name == "tolerance") {
      stage.tolerance = number();
    } else if (name == "solver") {
      stage.solver = value_of<Solver>(scalar_text(node, where), where);
    } else if (name == "time_step") {
      stage.motion.time_step = number();
    } else if (name == "mass") {
      stage.motion.mass = number();
    } else if (name == "damping") {
      stage.motion.damping = number();
    } else if (name == "energies" && node.is_table()) {
      for (const auto& [energy, weight] : *node.as_table()) {
        const std::string energy_name(energy.str());
        const std::string at = place_of(origin, weight, fmt::format("stage.energies.{}", energy_name));
        const EnergyKind* kind = find_energy(energy_name);
        if (kind == nullptr) {
          throw SettingError(fmt::format("unknown energy '{}'", energy_name), "energy", energy_name,
                             "see `energy` list")
              .at(at);
        }
        stage.energies[*kind] = number_of(scalar_text(weight, at), at);
      }
    } else {
      throw UsageError(
          fmt::format("unknown setting ({}): a stage has name, detail, energies, resolution, smoothing, smoothing_mm, "
                      "reach, max_steps, tolerance, solver, time_step, mass and damping",
                      where));
    }
  }
  return stage;
}

void apply_stages(const toml::node& node, const std::string& origin, SegmentSettings& settings) {
  const auto* array = node.as_array();
  if (array == nullptr) {
    throw UsageError(fmt::format("bad value ({}): write stages as [[stage]] tables", place_of(origin, node, "stage")));
  }
  settings.fit.stages.clear();
  for (const auto& element : *array) {
    const auto* table = element.as_table();
    if (table == nullptr) {
      throw UsageError(
          fmt::format("bad value ({}): write stages as [[stage]] tables", place_of(origin, element, "stage")));
    }
    settings.fit.stages.push_back(stage_of(*table, origin));
  }
}

std::map<std::string, double> by_name(const EnergyWeights& weights) {
  std::map<std::string, double> named;
  for (const auto& [kind, weight] : weights) named.emplace(kind->name, weight);
  return named;
}

std::string toml_table(const std::string& heading, const std::map<std::string, double>& weights) {
  if (weights.empty()) return {};
  std::string text = fmt::format("\n[{}]\n", heading);
  for (const auto& [name, weight] : weights) text += fmt::format("{} = {}\n", quoted(name), weight);
  return text;
}

}  // namespace

void apply_toml_file(const std::filesystem::path& path, SegmentSettings& settings,
                     const std::vector<SettingTarget>& host) {
  apply_toml_text(text_of_file(path), path.string(), settings, host);
}

void apply_toml_text(const std::string& text, const std::string& origin, SegmentSettings& settings,
                     const std::vector<SettingTarget>& host) {
  const auto section = [&](const std::string& name, const toml::node& node) {
    if (name == "stage") apply_stages(node, origin, settings);
    return name == "stage" || name == "description" || name == "when";  // these are notes: preset_notes.h
  };
  apply_table(parse_toml(text, origin), origin, "segment", joined(targets_of(segment_table(), settings), host),
              section);
}

std::string toml_of(const SegmentSettings& settings, const std::vector<SettingEntry>& host) {
  return toml_of(joined(entries_of(segment_table(), settings), host)) + toml_of_stages(settings.fit.stages);
}

std::string toml_of_stages(const std::vector<Stage>& stages) {
  std::string text;
  for (const auto& stage : stages) {
    text += fmt::format("\n[[stage]]\nname = {}\ndetail = {}\nresolution = {}\nsmoothing = {}\nreach = {}\n",
                        quoted(stage.name), stage.detail, stage.resolution, stage.smoothing, stage.reach);
    if (stage.smoothing_mm) text += fmt::format("smoothing_mm = {}\n", *stage.smoothing_mm);
    text += fmt::format("max_steps = {}\ntolerance = {}\nsolver = {}\n", stage.max_steps, stage.tolerance,
                        quoted(name_of(stage.solver)));
    const Motion& motion = stage.motion;
    text += fmt::format("time_step = {}\nmass = {}\ndamping = {}\n", motion.time_step, motion.mass, motion.damping);
    text += toml_table("stage.energies", by_name(stage.energies));
  }
  return text;
}

nlohmann::ordered_json json_of(const SegmentSettings& settings, const std::vector<SettingEntry>& host) {
  nlohmann::ordered_json json = json_of(joined(entries_of(segment_table(), settings), host));
  json["stage"] = nlohmann::ordered_json::array();
  for (const auto& stage : settings.fit.stages) {
    json["stage"].push_back({{"name", stage.name},
                             {"detail", stage.detail},
                             {"energies", by_name(stage.energies)},
                             {"resolution", stage.resolution},
                             {"smoothing", stage.smoothing},
                             {"reach", stage.reach},
                             {"max_steps", stage.max_steps},
                             {"tolerance", stage.tolerance},
                             {"solver", name_of(stage.solver)},
                             {"time_step", stage.motion.time_step},
                             {"mass", stage.motion.mass},
                             {"damping", stage.motion.damping}});
  }
  return json;
}

}  // namespace pellicle
