#pragma once
/// What a report says of a run beside its results: how it was started, and which files went in and came out.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pellicle/settings/preset_choice.h"
#include "pellicle/settings/setting_table.h"

namespace pellicle {

/// How a run was started.
struct RunRecord {
  std::vector<std::string> command_line = {};
  std::optional<PresetChoice> chosen_preset = {};  ///< with the preset `auto`
  std::vector<SettingEntry> host_settings = {};    ///< of the program around, such as those of its logs
};

struct InputFile {
  std::string role;  ///< "volume", "seeds", "seed-mask", "seed-model", "points"
  std::filesystem::path path;
  std::string sha256;
};

struct OutputFile {
  std::string kind;  ///< "mask", "mesh", ...
  std::filesystem::path path;
  std::string sha256;
  std::uintmax_t bytes = 0;
};

/// The file as it is on the disk now. \throws NoInput, IoError when it cannot be read.
OutputFile described(const std::string& kind, const std::filesystem::path& path);

}  // namespace pellicle
