#pragma once
/// The settings of a command as a table: one row a setting, which is a flag of the command line, a key of a TOML file
/// and a key of the report under the same name. Help, manual, completion, validation and TOML are made from it.

#include <functional>
#include <string>
#include <vector>

namespace pellicle {

/// Values as text: what stands after a flag, or the elements of a TOML array. Numbers read back to the same bits.
using SettingValues = std::vector<std::string>;

enum class SettingKind {
  flag,     ///< true or false
  number,   ///< one number
  text,     ///< one word, path or name
  words,    ///< list of words; on the command line separated by commas
  several,  ///< list of paths or names; on the command line separated by blanks
  vector,   ///< numbers; on the command line separated by commas
  vectors,  ///< several of them; the flag is repeated
  table,    ///< NAME=NUMBER; the flag is repeated; a TOML table
};

/// What a row says whatever struct holds the value.
struct SettingKey {
  std::string group;             ///< heading in the help
  std::string name;              ///< "seed-sphere": key of TOML and JSON
  std::string placeholder = {};  ///< "X,Y,Z,R"
  std::string help = {};         ///< with unit and default; names other settings in backquotes (setting_text.h)
  std::string short_flag = {};   ///< "-i" or empty
  std::string standard = {};     ///< default as the help shows it; empty: the value of default settings
  bool argument = false;         ///< stands at its place on the command line, without a flag
  bool required = false;
  bool recorded = true;  ///< part of the settings as resolved: of toml_of and json_of
  SettingKind kind = SettingKind::text;
  bool whole = false;  ///< of a number: an integer

  /// The words that it takes, one of them, as the placeholder lists them; empty for any other setting.
  std::vector<std::string> choices() const;
};

/// \param S the struct that holds the values.
template <class S>
struct Setting : SettingKey {
  std::function<void(S&, const SettingValues&)> set;  ///< \throws SettingError
  std::function<SettingValues(const S&)> get;         ///< empty: not set
};

/// In the order of the help.
template <class S>
using SettingTable = std::vector<Setting<S>>;

/// A setting and its value.
struct SettingEntry {
  const SettingKey* key = nullptr;  ///< lives as long as the table
  SettingValues values;
};

/// A setting and where its value goes.
struct SettingTarget {
  const SettingKey* key = nullptr;
  std::function<void(const SettingValues&)> set;  ///< \throws SettingError
};

/// The values of all settings, in the order of the table.
template <class S>
std::vector<SettingEntry> entries_of(const SettingTable<S>& table, const S& settings) {
  std::vector<SettingEntry> entries;
  for (const Setting<S>& row : table) entries.push_back({&row, row.get(settings)});
  return entries;
}

/// \param settings must live as long as the targets, as must the table.
template <class S>
std::vector<SettingTarget> targets_of(const SettingTable<S>& table, S& settings) {
  std::vector<SettingTarget> targets;
  for (const Setting<S>& row : table) {
    targets.push_back({&row, [&row, &settings](const SettingValues& values) { row.set(settings, values); }});
  }
  return targets;
}

/// One list after the other: settings of two structs as those of one command.
template <class T>
std::vector<T> joined(std::vector<T> first, const std::vector<T>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

}  // namespace pellicle
