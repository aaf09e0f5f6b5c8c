#pragma once
/// `pellicle segment` as 3D Slicer sees it: the description of a command-line module, made from its table of settings.

#include <string>
#include <vector>

#include "pellicle/settings/setting_table.h"

namespace pellicle {

/// XML of the Slicer Execution Model, by the rules of its parser (SlicerExecutionModel,
/// ModuleDescriptionParser/ModuleDescriptionParser.cxx): flags are the settings' names with underscores for dashes,
/// because the parser takes letters, digits and underscores only. Choices start with "default", which leaves a setting
/// to the preset: Slicer hands over every choice, typed or not.
/// \param settings all of the command, with their defaults.
std::string slicer_description(const std::vector<SettingEntry>& settings);

}  // namespace pellicle
