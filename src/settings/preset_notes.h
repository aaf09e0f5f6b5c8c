#pragma once
/// What a settings file says beside the settings themselves: its description, the preset that it builds on, and the
/// inputs that it is made for.

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace pellicle {

/// Facts of an input (image_facts.h) and the ranges they must lie in for a preset to fit it.
using PresetCondition = std::map<std::string, std::array<double, 2>>;

struct TomlNotes {
  std::string preset;                      ///< value of the key `preset`
  std::string description;                 ///< value of the key `description` (presets)
  std::vector<PresetCondition> when = {};  ///< the [[when]] tables (presets)
};

/// Only the notes, so that a preset can be applied before the file that names it.
/// \throws NoInput
/// \throws BadData for broken syntax.
/// \throws UsageError for a condition that is not a pair of numbers. All name file and line.
TomlNotes read_toml_notes(const std::filesystem::path& path);

}  // namespace pellicle
