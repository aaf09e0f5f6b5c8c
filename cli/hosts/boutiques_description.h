#pragma once
/// `pellicle segment` as a Boutiques tool, made from its table of settings.

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "pellicle/settings/setting_table.h"

namespace pellicle {

/// A descriptor of schema version 0.5: command line, inputs, groups of seeds that exclude each other, output files and
/// exit codes. `name` is required there, because the paths of the outputs are made of it.
/// \param settings all of the command, with their defaults.
nlohmann::ordered_json boutiques_description(const std::vector<SettingEntry>& settings);

}  // namespace pellicle
