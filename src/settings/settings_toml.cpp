#include "pellicle/settings/settings_toml.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "pellicle/base/errors.h"
#include "pellicle/energies/energy_kinds.h"

namespace pellicle {

namespace {

std::string slurp(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in || std::filesystem::is_directory(path)) {
    throw NoInput(fmt::format("cannot open ({}): no such settings file; check the path", path.string()));
  }
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

toml::table parse(const std::string& text, const std::string& origin) {
  try {
    return toml::parse(text, origin);
  } catch (const toml::parse_error& fault) {
    throw BadData(fmt::format("broken TOML ({}:{}): {}; see toml.io for the syntax", origin, fault.source().begin.line,
                              fault.description()));
  }
}

std::string place(const std::string& origin, const toml::node& node, const std::string& key) {
  return fmt::format("{}:{}, {}", origin, node.source().begin.line, key);
}

// One scalar as the text that the command line would have carried.
std::string scalar_text(const toml::node& node, const std::string& where) {
  if (const auto* v = node.as_string()) return v->get();
  if (const auto* v = node.as_boolean()) return v->get() ? "true" : "false";
  if (const auto* v = node.as_integer()) return fmt::format("{}", v->get());
  if (const auto* v = node.as_floating_point()) return fmt::format("{}", v->get());
  throw UsageError(fmt::format("bad value ({}): a number, a text or true/false is needed", where));
}

std::string joined(const toml::array& array, const std::string& where) {
  std::string text;
  for (const auto& element : array) {
    if (!text.empty()) text += ',';
    text += scalar_text(element, where);
  }
  return text;
}

SettingValues values_of(const SettingKey& key, const toml::node& node, const std::string& where) {
  SettingValues values;
  if (key.kind == SettingKind::table) {
    const auto* table = node.as_table();
    if (table == nullptr) throw UsageError(fmt::format("bad value ({}): a table NAME = WEIGHT is needed", where));
    for (const auto& [name, weight] : *table) {
      values.push_back(fmt::format("{}={}", name.str(), scalar_text(weight, where)));
    }
    return values;
  }
  const auto* array = node.as_array();
  const bool is_list =
      key.kind == SettingKind::words || key.kind == SettingKind::vector || key.kind == SettingKind::vectors;
  if (array != nullptr && is_list) {
    const bool nested = !array->empty() && array->front().is_array();
    if (key.kind == SettingKind::vectors && !nested) return {joined(*array, where)};
    for (const auto& element : *array) {
      const auto* inner = element.as_array();
      values.push_back(inner != nullptr && key.kind == SettingKind::vectors ? joined(*inner, where)
                                                                            : scalar_text(element, where));
    }
    return values;
  }
  const std::string text = scalar_text(node, where);
  if (key.kind == SettingKind::words || key.kind == SettingKind::vector) return split_commas(text);
  if (key.kind == SettingKind::number && node.is_string()) {
    throw UsageError(fmt::format("bad value ({}): a number is needed, not the text '{}'", where, text));
  }
  return {text};
}

Stage stage_of(const toml::table& table, const std::string& origin) {
  Stage stage;
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    const std::string where = place(origin, node, fmt::format("stage.{}", name));
    if (name == "name") {
      stage.name = scalar_text(node, where);
    } else if (name == "detail") {
      stage.detail = integer_of(scalar_text(node, where), where);
    } else if (name == "max_steps") {
      stage.max_steps = integer_of(scalar_text(node, where), where);
    } else if (name == "resolution") {
      stage.resolution = number_of(scalar_text(node, where), where);
    } else if (name == "smoothing") {
      stage.smoothing = number_of(scalar_text(node, where), where);
    } else if (name == "reach") {
      stage.reach = number_of(scalar_text(node, where), where);
    } else if (name == "tolerance") {
      stage.tolerance = number_of(scalar_text(node, where), where);
    } else if (name == "solver") {
      stage.solver = value_of<Solver>(scalar_text(node, where), where);
    } else if (name == "time_step") {
      stage.motion.time_step = number_of(scalar_text(node, where), where);
    } else if (name == "mass") {
      stage.motion.mass = number_of(scalar_text(node, where), where);
    } else if (name == "damping") {
      stage.motion.damping = number_of(scalar_text(node, where), where);
    } else if (name == "energies" && node.is_table()) {
      for (const auto& [energy, weight] : *node.as_table()) {
        stage.energies[energy_named(energy.str(), where)] = number_of(scalar_text(weight, where), where);
      }
    } else {
      throw UsageError(
          fmt::format("unknown setting ({}): a stage has name, detail, energies, resolution, smoothing, "
                      "reach, max_steps, tolerance, solver, time_step, mass and damping",
                      where));
    }
  }
  return stage;
}

void apply_stages(const toml::node& node, const std::string& origin, SegmentSettings& settings) {
  const auto* array = node.as_array();
  if (array == nullptr) {
    throw UsageError(fmt::format("bad value ({}): write stages as [[stage]] tables", place(origin, node, "stage")));
  }
  settings.fit.stages.clear();
  for (const auto& element : *array) {
    const auto* table = element.as_table();
    if (table == nullptr) {
      throw UsageError(
          fmt::format("bad value ({}): write stages as [[stage]] tables", place(origin, element, "stage")));
    }
    settings.fit.stages.push_back(stage_of(*table, origin));
  }
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    } else {
      out += c;
    }
  }
  return out + '"';
}

std::string toml_value(const SettingKey& key, const SettingValues& values) {
  switch (key.kind) {
    case SettingKind::flag:
    case SettingKind::number:
      return values.at(0);
    case SettingKind::text:
      return quoted(values.at(0));
    case SettingKind::words:
    case SettingKind::vector:
    case SettingKind::vectors: {
      std::string text;
      for (const auto& value : values) {
        text += text.empty() ? "" : ", ";
        text += key.kind == SettingKind::words     ? quoted(value)
                : key.kind == SettingKind::vectors ? fmt::format("[{}]", value)
                                                   : value;
      }
      return "[" + text + "]";
    }
    case SettingKind::table:
      break;
  }
  return {};
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

nlohmann::ordered_json number_json(const std::string& text) {
  return nlohmann::ordered_json::parse(text);
}

nlohmann::ordered_json json_value(const SettingKey& key, const SettingValues& values) {
  using json = nlohmann::ordered_json;
  switch (key.kind) {
    case SettingKind::flag:
      return values.at(0) == "true";
    case SettingKind::number:
      return number_json(values.at(0));
    case SettingKind::text:
      return values.at(0);
    case SettingKind::words:
      return values;
    case SettingKind::vector: {
      json list = json::array();
      for (const auto& value : values) list.push_back(number_json(value));
      return list;
    }
    case SettingKind::vectors: {
      json list = json::array();
      for (const auto& value : values) list.push_back(number_json(fmt::format("[{}]", value)));
      return list;
    }
    case SettingKind::table:
      break;
  }
  return nullptr;
}

}  // namespace

namespace {

std::array<double, 2> range_of(const toml::node& node, const std::string& where) {
  const auto* array = node.as_array();
  if (array != nullptr && array->size() == 2) {
    const auto low = array->get(0)->value<double>(), high = array->get(1)->value<double>();
    if (low && high && *low <= *high) return {*low, *high};
  }
  throw UsageError(fmt::format("bad value ({}): a range [LOW, HIGH] is needed; HIGH may be inf", where));
}

std::vector<PresetCondition> conditions_of(const toml::table& table, const std::string& origin) {
  std::vector<PresetCondition> conditions;
  const auto* array = table["when"].as_array();
  if (array == nullptr) {
    if (const auto* node = table.get("when"); node != nullptr)
      throw UsageError(
          fmt::format("bad value ({}): write conditions as [[when]] tables", place(origin, *node, "when")));
    return conditions;
  }
  for (const auto& element : *array) {
    const auto* facts = element.as_table();
    if (facts == nullptr)
      throw UsageError(
          fmt::format("bad value ({}): write conditions as [[when]] tables", place(origin, element, "when")));
    PresetCondition condition;
    for (const auto& [name, node] : *facts) {
      const std::string fact(name.str());
      condition[fact] = range_of(node, place(origin, node, "when." + fact));
    }
    conditions.push_back(std::move(condition));
  }
  return conditions;
}

}  // namespace

TomlNotes read_toml_notes(const std::filesystem::path& path) {
  const toml::table table = parse(slurp(path), path.string());
  return {table["preset"].value_or(std::string()), table["description"].value_or(std::string()),
          conditions_of(table, path.string())};
}

void apply_toml_file(const std::filesystem::path& path, SegmentSettings& settings) {
  apply_toml_text(slurp(path), path.string(), settings);
}

void apply_toml_text(const std::string& text, const std::string& origin, SegmentSettings& settings) {
  const toml::table table = parse(text, origin);
  for (const auto& [toml_key, node] : table) {
    const std::string name(toml_key.str());
    if (name == "description" || name == "when") continue;
    if (name == "stage") {
      apply_stages(node, origin, settings);
      continue;
    }
    const auto& keys = segment_keys();
    const auto key = std::find_if(keys.begin(), keys.end(), [&](const SettingKey& k) { return k.name == name; });
    const std::string where = place(origin, node, name);
    if (key == keys.end()) {
      throw UsageError(fmt::format(
          "unknown setting ({}): no flag of 'pellicle segment' has this name; see pellicle segment --help", where));
    }
    key->set(settings, values_of(*key, node, where), where);
  }
}

std::string toml_of(const SegmentSettings& settings) {
  std::string text;
  for (const auto& key : segment_keys()) {
    if (key.name == "dry-run" || key.kind == SettingKind::table) continue;
    const SettingValues values = key.get(settings);
    if (!values.empty()) text += fmt::format("{} = {}\n", key.name, toml_value(key, values));
  }
  text += toml_table("energy", by_name(settings.fit.energies));
  return text + toml_of_stages(settings.fit.stages);
}

std::string toml_of_stages(const std::vector<Stage>& stages) {
  std::string text;
  for (const auto& stage : stages) {
    text += fmt::format("\n[[stage]]\nname = {}\ndetail = {}\nresolution = {}\nsmoothing = {}\nreach = {}\n",
                        quoted(stage.name), stage.detail, stage.resolution, stage.smoothing, stage.reach);
    text += fmt::format("max_steps = {}\ntolerance = {}\nsolver = {}\n", stage.max_steps, stage.tolerance,
                        quoted(name_of(stage.solver)));
    const Motion& motion = stage.motion;
    text += fmt::format("time_step = {}\nmass = {}\ndamping = {}\n", motion.time_step, motion.mass, motion.damping);
    text += toml_table("stage.energies", by_name(stage.energies));
  }
  return text;
}

nlohmann::ordered_json json_of(const SegmentSettings& settings) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const auto& key : segment_keys()) {
    if (key.name == "dry-run" || key.kind == SettingKind::table) continue;
    const SettingValues values = key.get(settings);
    if (!values.empty()) json[key.name] = json_value(key, values);
  }
  json["energy"] = by_name(settings.fit.energies);
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
