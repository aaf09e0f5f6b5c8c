#pragma once
/// Reading of TOML files with faults that name file, line and key.

#include <toml++/toml.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "pellicle/settings/setting_table.h"

namespace pellicle {

/// The bytes of a file. \throws NoInput
std::string text_of_file(const std::filesystem::path& path);

/// \param origin names the text in faults: its file.
/// \throws BadData for broken syntax.
toml::table parse_toml(const std::string& text, const std::string& origin);

/// "run.toml:3, detail".
std::string place_of(const std::string& origin, const toml::node& node, const std::string& key);

/// One scalar as the text that the command line would have carried.
/// \throws UsageError that names `where`.
std::string scalar_text(const toml::node& node, const std::string& where);

/// A section that is more than a setting: whether it took the key.
using TomlSection = std::function<bool(const std::string& key, const toml::node& node)>;

/// Sets all that the table holds, and nothing else.
/// \param command whose settings they are, for the message about an unknown key.
/// \throws UsageError naming file, line and key.
void apply_table(const toml::table& table, const std::string& origin, const std::string& command,
                 const std::vector<SettingTarget>& targets, const TomlSection& section);

/// A TOML string.
std::string quoted(const std::string& text);

}  // namespace pellicle
