#pragma once
/// Settings of a segmentation as TOML: presets, `config` files and dry runs all speak it. Every setting is a key;
/// [energy] is a table of weights, [[stage]] an array of the stages of a fit.

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "pellicle/settings/settings.h"

namespace pellicle {

/// Sets in `settings` all that the file holds, and nothing else.
/// \param host settings of the program around, such as those of its logs, that the file may hold too.
/// \throws NoInput
/// \throws BadData for broken syntax.
/// \throws UsageError for an unknown key or an impossible value. All name the file, the line and the key.
void apply_toml_file(const std::filesystem::path& path, SegmentSettings& settings,
                     const std::vector<SettingTarget>& host = {});
/// The same from a string.
/// \param origin stands for the file's name in messages.
void apply_toml_text(const std::string& text, const std::string& origin, SegmentSettings& settings,
                     const std::vector<SettingTarget>& host = {});

/// All settings that have a value, one per line; read back by apply_toml_text they are the same to the last bit.
/// \param host settings of the program around: after the others, before the tables.
std::string toml_of(const SegmentSettings& settings, const std::vector<SettingEntry>& host = {});
/// Only the [[stage]] tables.
std::string toml_of_stages(const std::vector<Stage>& stages);
/// The same content for the report.
nlohmann::ordered_json json_of(const SegmentSettings& settings, const std::vector<SettingEntry>& host = {});

}  // namespace pellicle
