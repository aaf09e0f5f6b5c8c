#include "pellicle/settings/toml_settings.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "pellicle/settings/internal/toml_reading.h"
#include "pellicle/settings/setting_words.h"

namespace pellicle {

namespace {

std::string toml_list(const SettingKey& key, const SettingValues& values) {
  std::string text;
  for (const auto& value : values) {
    text += text.empty() ? "" : ", ";
    text += key.kind == SettingKind::vector    ? value
            : key.kind == SettingKind::vectors ? fmt::format("[{}]", value)
                                               : quoted(value);
  }
  return "[" + text + "]";
}

std::string toml_value(const SettingKey& key, const SettingValues& values) {
  if (key.kind == SettingKind::flag || key.kind == SettingKind::number) return values.at(0);
  if (key.kind == SettingKind::text) return quoted(values.at(0));
  return toml_list(key, values);
}

// "edge=0.5" -> {"edge", "0.5"}.
std::pair<std::string, std::string> halves(const std::string& weight) {
  const auto equals = weight.find('=');
  return {weight.substr(0, equals), weight.substr(equals + 1)};
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
    case SettingKind::several:
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
    case SettingKind::table: {
      json table = json::object();
      for (const auto& value : values) {
        const auto [name, weight] = halves(value);
        table[name] = number_of(weight, key.name);
      }
      return table;
    }
  }
  return nullptr;
}

}  // namespace

void apply_toml_file(const std::filesystem::path& path, const std::string& command,
                     const std::vector<SettingTarget>& targets) {
  apply_toml_text(text_of_file(path), path.string(), command, targets);
}

void apply_toml_text(const std::string& text, const std::string& origin, const std::string& command,
                     const std::vector<SettingTarget>& targets) {
  apply_table(parse_toml(text, origin), origin, command, targets, {});
}

std::string toml_of(const std::vector<SettingEntry>& settings) {
  std::string text, tables;
  for (const auto& [key, values] : settings) {
    if (!key->recorded || values.empty()) continue;
    if (key->kind != SettingKind::table) {
      text += fmt::format("{} = {}\n", key->name, toml_value(*key, values));
      continue;
    }
    tables += fmt::format("\n[{}]\n", key->name);
    for (const auto& value : values) {
      const auto [name, weight] = halves(value);
      tables += fmt::format("{} = {}\n", quoted(name), weight);
    }
  }
  return text + tables;
}

nlohmann::ordered_json json_of(const std::vector<SettingEntry>& settings) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  nlohmann::ordered_json tables = nlohmann::ordered_json::object();
  for (const auto& [key, values] : settings) {
    if (!key->recorded) continue;
    if (key->kind == SettingKind::table) {
      tables[key->name] = json_value(*key, values);
    } else if (!values.empty()) {
      json[key->name] = json_value(*key, values);
    }
  }
  json.update(tables);
  return json;
}

}  // namespace pellicle
