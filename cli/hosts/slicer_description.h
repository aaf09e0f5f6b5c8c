#pragma once
/// `pellicle segment` as 3D Slicer sees it: the description of a command-line module, from the one table of settings.

#include <string>

namespace pellicle {

/// XML of the Slicer Execution Model, by the rules of its parser (SlicerExecutionModel,
/// ModuleDescriptionParser/ModuleDescriptionParser.cxx): flags are the settings' names with underscores for dashes,
/// because the parser takes letters, digits and underscores only. Choices start with "default", which leaves a setting
/// to the preset: Slicer hands over every choice, typed or not.
std::string slicer_description();

}  // namespace pellicle
