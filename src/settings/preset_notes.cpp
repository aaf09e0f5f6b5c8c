#include "pellicle/settings/preset_notes.h"

#include <fmt/format.h>

#include "pellicle/base/errors.h"
#include "pellicle/settings/internal/toml_reading.h"

namespace pellicle {

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
          fmt::format("bad value ({}): write conditions as [[when]] tables", place_of(origin, *node, "when")));
    return conditions;
  }
  for (const auto& element : *array) {
    const auto* facts = element.as_table();
    if (facts == nullptr)
      throw UsageError(
          fmt::format("bad value ({}): write conditions as [[when]] tables", place_of(origin, element, "when")));
    PresetCondition condition;
    for (const auto& [name, node] : *facts) {
      const std::string fact(name.str());
      condition[fact] = range_of(node, place_of(origin, node, "when." + fact));
    }
    conditions.push_back(std::move(condition));
  }
  return conditions;
}

}  // namespace

TomlNotes read_toml_notes(const std::filesystem::path& path) {
  const toml::table table = parse_toml(text_of_file(path), path.string());
  return {table["preset"].value_or(std::string()), table["description"].value_or(std::string()),
          conditions_of(table, path.string())};
}

}  // namespace pellicle
