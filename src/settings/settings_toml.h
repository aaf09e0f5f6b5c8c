#pragma once
/// Settings as TOML: presets, `config` files and `dry-run` all speak it. Every flag of `pellicle segment` is a key;
/// [energy] is a table of weights, [[stage]] an array of the stages of a fit.

#include <filesystem>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "pellicle/settings/presets.h"
#include "pellicle/settings/settings.h"

namespace pellicle {

/// What a TOML file asks for beside the values themselves.
struct TomlNotes {
  std::string preset;                      ///< value of the key `preset`
  std::string description;                 ///< value of the key `description` (presets)
  std::vector<PresetCondition> when = {};  ///< the [[when]] tables (presets)
};

/// Only the notes, so that a preset can be applied before the file that names it.
/// \throws NoInput, BadData (syntax), UsageError (a condition that is no pair of numbers) naming file and line.
TomlNotes read_toml_notes(const std::filesystem::path& path);

/// Sets in `settings` all that the file holds, and nothing else.
/// \throws NoInput; BadData for broken syntax; UsageError for an unknown key or an impossible value: all name the file,
///         the line and the key.
void apply_toml_file(const std::filesystem::path& path, SegmentSettings& settings);
/// The same from a string; `origin` stands for the file's name in messages.
void apply_toml_text(const std::string& text, const std::string& origin, SegmentSettings& settings);

/// All settings that have a value, one a line; read back by apply_toml_text they are the same to the last bit.
std::string toml_of(const SegmentSettings& settings);
/// Only the [[stage]] tables.
std::string toml_of_stages(const std::vector<Stage>& stages);
/// The same content for the report, except `dry-run`.
nlohmann::ordered_json json_of(const SegmentSettings& settings);

}  // namespace pellicle
