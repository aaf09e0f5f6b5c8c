#pragma once
/// Settings of any command as TOML and JSON: a key for each setting, under the name of its flag.

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "pellicle/settings/setting_table.h"

namespace pellicle {

/// All settings that have a value, one per line, tables last; read back they are the same to the last bit.
std::string toml_of(const std::vector<SettingEntry>& settings);
nlohmann::ordered_json json_of(const std::vector<SettingEntry>& settings);

/// Sets all that the file holds, and nothing else.
/// \param command "fit": named in the message about an unknown key.
/// \throws NoInput
/// \throws BadData for broken syntax.
/// \throws UsageError for an unknown key or an impossible value. All name the file, the line and the key.
void apply_toml_file(const std::filesystem::path& path, const std::string& command,
                     const std::vector<SettingTarget>& targets);
/// The same from a string. \param origin stands for the file's name in messages.
void apply_toml_text(const std::string& text, const std::string& origin, const std::string& command,
                     const std::vector<SettingTarget>& targets);

}  // namespace pellicle
