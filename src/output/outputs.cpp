#include "pellicle/output/outputs.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <stdexcept>

#include "pellicle/base/errors.h"

namespace pellicle {
namespace fs = std::filesystem;

std::vector<PlannedFile> plan_outputs(const SegmentSettings& settings, const std::vector<int>& labels) {
  const std::string stem = stem_of(settings);
  const bool several = labels.size() > 1 || settings.wants_many();
  std::vector<PlannedFile> plan;
  const auto add = [&](const std::string& kind, int label, const std::string& suffix) {
    plan.push_back({kind, label, settings.output / (stem + suffix)});
  };
  const auto add_each = [&](const std::string& kind, const std::string& suffix, const std::string& extension) {
    for (const int label : labels) {
      add(kind, several ? label : 0,
          several ? fmt::format("{}-{:03}{}", suffix, label, extension) : suffix + extension);
    }
  };
  if (settings.writes("mask")) {
    add("mask", 0, several ? "_dseg.nii.gz" : "_mask.nii.gz");
    if (several) add("labels", 0, "_dseg.tsv");
  }
  if (settings.writes("mesh")) add_each("mesh", "_surface", extension_of(settings.mesh_format));
  if (settings.writes("model")) add_each("model", "_model", ".json");
  if (settings.writes("sdf")) add("sdf", 0, "_sdf.nii.gz");
  if (settings.writes("prob")) add("prob", 0, "_prob.nii.gz");
  if (settings.writes("qc")) add("qc", 0, "_qc.png");
  if (settings.writes("convergence")) add("convergence", 0, "_convergence.png");
  if (settings.output_mask) plan.push_back({"output-mask", 0, *settings.output_mask});
  if (settings.output_mesh) plan.push_back({"output-mesh", 0, *settings.output_mesh});
  if (settings.writes("report")) add("report", 0, "_report.json");
  return plan;
}

namespace {

// STEM_surface-NNN.EXT of any mesh format, or STEM_model-NNN.json.
bool is_numbered(const std::string& name, const std::string& stem) {
  for (const std::string kind : {"_surface-", "_model-"}) {
    if (name.rfind(stem + kind, 0) != 0) continue;
    const std::string rest = name.substr(stem.size() + kind.size());
    const std::size_t digits = std::min(rest.find_first_not_of("0123456789"), rest.size());
    const std::string extension = rest.substr(digits);
    static const std::vector<std::string> meshes{".ply", ".stl", ".obj", ".vtp", ".gii", ".surf.gii"};
    if (digits >= 3 &&
        (kind == "_model-" ? extension == ".json" : std::find(meshes.begin(), meshes.end(), extension) != meshes.end()))
      return true;
  }
  return false;
}

}  // namespace

std::vector<fs::path> stale_outputs(const SegmentSettings& settings, const std::vector<PlannedFile>& plan) {
  std::vector<fs::path> stale;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(settings.output, ignored)) {
    const std::string name = entry.path().filename().string();
    const bool planned =
        std::any_of(plan.begin(), plan.end(), [&](const PlannedFile& f) { return f.path.filename() == name; });
    if (!planned && is_numbered(name, stem_of(settings)) && entry.is_regular_file(ignored))
      stale.push_back(entry.path());
  }
  std::sort(stale.begin(), stale.end());
  return stale;
}

fs::path path_of(const std::vector<PlannedFile>& plan, const std::string& kind, int label) {
  for (const auto& file : plan) {
    if (file.kind == kind && file.label == label) return file.path;
  }
  throw std::logic_error("no such planned file: " + kind);
}

std::vector<fs::path> paths_of(const std::vector<PlannedFile>& plan) {
  std::vector<fs::path> paths;
  paths.reserve(plan.size());
  for (const PlannedFile& file : plan) paths.push_back(file.path);
  return paths;
}

namespace {

void check_folder(const fs::path& folder) {
  std::error_code ignored;
  fs::path existing = folder.empty() ? fs::path(".") : folder;
  while (!fs::exists(existing, ignored)) {
    existing =
        existing.has_parent_path() && existing.parent_path() != existing ? existing.parent_path() : fs::path(".");
  }
  if (!fs::is_directory(existing, ignored)) {
    throw CannotCreate(fmt::format("cannot create output ({}): {} is a file, not a folder; choose another folder",
                                   folder.string(), existing.string()));
  }
  if (access(existing.c_str(), W_OK | X_OK) != 0) {
    throw CannotCreate(fmt::format("cannot create output ({}): no permission to write in {}; choose another folder",
                                   folder.string(), existing.string()));
  }
}

}  // namespace

void check_outputs(const std::vector<fs::path>& paths, bool overwrite, const std::vector<fs::path>& inputs) {
  std::error_code ignored;
  for (const auto& path : paths) {
    check_folder(path.parent_path());
    for (const auto& input : inputs) {
      if (fs::equivalent(path, input, ignored)) {
        throw UsageError(fmt::format("output is an input ({}): it would be replaced; choose another `name` or folder",
                                     path.string()));
      }
    }
    if (fs::is_directory(path, ignored)) {
      throw CannotCreate(fmt::format("cannot create output ({}): a folder has this name; remove it", path.string()));
    }
    if (!overwrite && fs::exists(path, ignored)) {
      throw CannotCreate(fmt::format(
          "output exists ({}): it is not replaced; give `overwrite`, another `name` or folder", path.string()));
    }
  }
}

void create_folder(const fs::path& folder) {
  std::error_code fault;
  if (folder.empty()) return;
  fs::create_directories(folder, fault);
  if (fault) {
    throw CannotCreate(
        fmt::format("cannot create output ({}): {}; choose another folder", folder.string(), fault.message()));
  }
}

}  // namespace pellicle
