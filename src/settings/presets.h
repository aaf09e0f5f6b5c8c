#pragma once
/// Presets: TOML files that anybody may copy and edit.

#include <filesystem>
#include <string>
#include <vector>

#include "pellicle/settings/preset_notes.h"

namespace pellicle {

struct Preset {
  std::string name, description;
  std::filesystem::path path;
  std::vector<PresetCondition> when = {};  ///< any of them is enough for the preset "auto"; none: never chosen
};

/// Folders that hold presets, first wins: $PELLICLE_PRESETS, ../share/pellicle/presets beside the running program,
/// and the source tree's own when the program runs from its build tree.
std::vector<std::filesystem::path> preset_folders();

/// Sorted by name.
std::vector<Preset> list_presets();

/// By name, or a path that ends in ".toml".
/// \throws SettingError naming the known presets.
/// \throws NoInput for an absent file.
std::filesystem::path find_preset(const std::string& name_or_path);

}  // namespace pellicle
