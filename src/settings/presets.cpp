#include "pellicle/settings/presets.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>

#include "pellicle/base/errors.h"

namespace pellicle {
namespace fs = std::filesystem;

std::vector<fs::path> preset_folders() {
  std::vector<fs::path> folders;
  if (const char* folder = std::getenv("PELLICLE_PRESETS"); folder != nullptr && *folder != '\0') {
    folders.emplace_back(folder);
  }
  std::error_code ignored;
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
  if (!program.empty()) folders.push_back(program.parent_path().parent_path() / "share" / "pellicle" / "presets");
#ifdef PELLICLE_BUILD_FOLDER
  // Only a program that runs from the build tree may look into the source tree.
  const std::string build = std::string(PELLICLE_BUILD_FOLDER) + "/";
  if (program.string().rfind(build, 0) == 0) folders.emplace_back(PELLICLE_SOURCE_PRESETS);
#endif
  return folders;
}

std::vector<Preset> list_presets() {
  std::map<std::string, Preset> by_name;
  for (const auto& folder : preset_folders()) {
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder, ignored)) {
      if (entry.path().extension() != ".toml") continue;
      const std::string name = entry.path().stem().string();
      if (by_name.contains(name)) continue;
      const TomlNotes notes = read_toml_notes(entry.path());
      by_name.emplace(name, Preset{name, notes.description, entry.path(), notes.when});
    }
  }
  std::vector<Preset> presets;
  presets.reserve(by_name.size());
  for (auto& [name, preset] : by_name) presets.push_back(std::move(preset));
  return presets;
}

fs::path find_preset(const std::string& name_or_path) {
  if (name_or_path.ends_with(".toml")) {
    if (!fs::is_regular_file(name_or_path)) {
      throw NoInput(
          fmt::format("no such file (`preset` {}): there is no preset file here; see `preset` list", name_or_path));
    }
    return name_or_path;
  }
  std::string known;
  for (const auto& preset : list_presets()) {
    if (preset.name == name_or_path) return preset.path;
    known += (known.empty() ? "" : ", ") + preset.name;
  }
  throw SettingError("unknown preset", "preset", name_or_path,
                     fmt::format("known are {}; or give a path to a .toml file", known.empty() ? "none" : known));
}

}  // namespace pellicle
