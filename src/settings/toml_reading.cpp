#include "pellicle/settings/internal/toml_reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "pellicle/base/errors.h"
#include "pellicle/settings/setting_words.h"

namespace pellicle {

std::string text_of_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in || std::filesystem::is_directory(path)) {
    throw NoInput(fmt::format("cannot open ({}): no such settings file; check the path", path.string()));
  }
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

toml::table parse_toml(const std::string& text, const std::string& origin) {
  try {
    return toml::parse(text, origin);
  } catch (const toml::parse_error& fault) {
    throw BadData(fmt::format("broken TOML ({}:{}): {}; see toml.io for the syntax", origin, fault.source().begin.line,
                              fault.description()));
  }
}

std::string place_of(const std::string& origin, const toml::node& node, const std::string& key) {
  return fmt::format("{}:{}, {}", origin, node.source().begin.line, key);
}

std::string scalar_text(const toml::node& node, const std::string& where) {
  if (const auto* v = node.as_string()) return v->get();
  if (const auto* v = node.as_boolean()) return v->get() ? "true" : "false";
  if (const auto* v = node.as_integer()) return fmt::format("{}", v->get());
  if (const auto* v = node.as_floating_point()) return fmt::format("{}", v->get());
  throw UsageError(fmt::format("bad value ({}): a number, a text or true/false is needed", where));
}

namespace {

std::string joined_scalars(const toml::array& array, const std::string& where) {
  SettingValues words;
  for (const auto& element : array) words.push_back(scalar_text(element, where));
  return joined_by_commas(words);
}

SettingValues values_of_table(const toml::node& node, const std::string& where) {
  const auto* table = node.as_table();
  if (table == nullptr) throw UsageError(fmt::format("bad value ({}): a table NAME = WEIGHT is needed", where));
  SettingValues values;
  for (const auto& [name, weight] : *table) {
    values.push_back(fmt::format("{}={}", name.str(), scalar_text(weight, where)));
  }
  return values;
}

SettingValues values_of_array(const SettingKey& key, const toml::array& array, const std::string& where) {
  const bool vectors = key.kind == SettingKind::vectors;
  const bool nested = !array.empty() && array.front().is_array();
  if (vectors && !nested) return {joined_scalars(array, where)};
  SettingValues values;
  for (const auto& element : array) {
    const auto* inner = element.as_array();
    values.push_back(inner != nullptr && vectors ? joined_scalars(*inner, where) : scalar_text(element, where));
  }
  return values;
}

bool is_list(SettingKind kind) {
  return kind == SettingKind::words || kind == SettingKind::several || kind == SettingKind::vector ||
         kind == SettingKind::vectors;
}

SettingValues values_of(const SettingKey& key, const toml::node& node, const std::string& where) {
  if (key.kind == SettingKind::table) return values_of_table(node, where);
  if (const auto* array = node.as_array(); array != nullptr && is_list(key.kind)) {
    return values_of_array(key, *array, where);
  }
  const std::string text = scalar_text(node, where);
  if (key.kind == SettingKind::words || key.kind == SettingKind::vector) return split_commas(text);
  if (key.kind == SettingKind::number && node.is_string()) {
    throw UsageError(fmt::format("bad value ({}): a number is needed, not the text '{}'", where, text));
  }
  return {text};
}

}  // namespace

void apply_table(const toml::table& table, const std::string& origin, const std::string& command,
                 const std::vector<SettingTarget>& targets, const TomlSection& section) {
  for (const auto& [toml_key, node] : table) {
    const std::string name(toml_key.str());
    if (section && section(name, node)) continue;
    const auto target =
        std::find_if(targets.begin(), targets.end(), [&](const SettingTarget& t) { return t.key->name == name; });
    const std::string where = place_of(origin, node, name);
    if (target == targets.end()) {
      throw UsageError(
          fmt::format("unknown setting ({}): 'pellicle {}' has no setting of this name; see 'pellicle {} "
                      "`help`'",
                      where, command, command));
    }
    try {
      target->set(values_of(*target->key, node, where));
    } catch (const SettingError& fault) {
      throw fault.at(where);
    }
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

}  // namespace pellicle
