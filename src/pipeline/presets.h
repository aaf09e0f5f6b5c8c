#pragma once
/// Presets: TOML files that anybody may copy and edit.

#include <filesystem>
#include <string>
#include <vector>

namespace pellicle {

struct Preset {
  std::string name, description;
  std::filesystem::path path;
};

/// Folders that hold presets, first wins: $PELLICLE_PRESETS, ../share/pellicle/presets beside the running program,
/// and the source tree's own when the program runs from its build tree.
std::vector<std::filesystem::path> preset_folders();

/// Sorted by name.
std::vector<Preset> list_presets();

/// By name, or a path that ends in ".toml". \throws UsageError naming the known presets; NoInput for an absent file.
std::filesystem::path find_preset(const std::string& name_or_path);

}  // namespace pellicle
