#pragma once
/// What `pellicle evaluate` reads and prints.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "pellicle/job/evaluate.h"

namespace pellicle {

/// By extension: meshes; .json (a model, or a phantom's truth with its .nii.gz and, but for a cluster, .ply beside it);
/// else a label map.
/// \throws NoInput, BadData.
EvaluationInput read_evaluation_input(const std::filesystem::path& path);

nlohmann::ordered_json json_of(const Evaluation& evaluation);
/// For people: aligned columns, one line for each label, ends with a line break.
std::string table_of(const Evaluation& evaluation);

}  // namespace pellicle
