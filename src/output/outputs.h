#pragma once
/// Names of the files of a run, and whether they may be created.

#include <filesystem>
#include <string>
#include <vector>

#include "pellicle/settings/settings.h"

namespace pellicle {

struct PlannedFile {
  std::string kind;  ///< "mask", "labels" (the .tsv), "mesh", "model", "sdf", "prob", "qc", "convergence", "report";
                     ///< "trace"; "output-mask", "output-mesh"
  int label = 0;     ///< of the object for per-object files of a run with several; 0 otherwise
  std::filesystem::path path;
};

/// The files that a run over objects with these labels writes.
std::vector<PlannedFile> plan_outputs(const SegmentSettings& settings, const std::vector<int>& labels);

/// Numbered meshes and models of this stem in the output folder that are not planned: left by an earlier run that found
/// more objects, they would pass for results of this one. In the order of their names.
std::vector<std::filesystem::path> stale_outputs(const SegmentSettings& settings, const std::vector<PlannedFile>& plan);

/// The path of one planned file. \pre it is planned.
std::filesystem::path path_of(const std::vector<PlannedFile>& plan, const std::string& kind, int label = 0);

std::vector<std::filesystem::path> paths_of(const std::vector<PlannedFile>& plan);

/// \throws CannotCreate: a path exists and may not be replaced, `folder` is no folder, or nothing can be created in it
///         (or, when it is missing, in its nearest existing parent). UsageError: a path is one of the inputs.
void check_outputs(const std::vector<std::filesystem::path>& paths, bool overwrite,
                   const std::vector<std::filesystem::path>& inputs);

/// Creates the folder. \throws CannotCreate.
void create_folder(const std::filesystem::path& folder);

}  // namespace pellicle
