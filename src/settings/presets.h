#pragma once
/// Presets: TOML files that anybody may copy and edit.

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace pellicle {

/// Facts of an input (image_facts.h) and the ranges they must lie in for a preset to fit it.
using PresetCondition = std::map<std::string, std::array<double, 2>>;

struct Preset {
  std::string name, description;
  std::filesystem::path path;
  std::vector<PresetCondition> when = {};  ///< any of them is enough for `preset` auto; none: never chosen
};

/// Folders that hold presets, first wins: $PELLICLE_PRESETS, ../share/pellicle/presets beside the running program,
/// and the source tree's own when the program runs from its build tree.
std::vector<std::filesystem::path> preset_folders();

/// Sorted by name.
std::vector<Preset> list_presets();

/// By name, or a path that ends in ".toml". \throws UsageError naming the known presets; NoInput for an absent file.
std::filesystem::path find_preset(const std::string& name_or_path);

}  // namespace pellicle
