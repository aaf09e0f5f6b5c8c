#pragma once
/// Settings of `pellicle fit`: from points, a mesh or a mask to a fitted surface.

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pellicle/fit/geometry/size_search.h"
#include "pellicle/mesh/files/mesh_file.h"
#include "pellicle/settings/setting_table.h"

namespace pellicle {

struct GeometryFitSettings {
  std::string input;  ///< FILE, or FILE:LABEL for label maps
  std::filesystem::path output;
  std::string name;  ///< file stem; empty: the input's name without its extensions
  ModelChoice model;
  /// Refinements of the start model; of a spline the last rung, see rungs(); with a tolerance: at most.
  std::optional<int> detail;
  std::optional<double> tolerance_mm, tolerance_percent;  ///< of the residual, data to surface
  ToleranceOf tolerance_of = ToleranceOf::rms;
  std::optional<std::array<int, 2>> size;  ///< M1, M2 of a spline
  std::vector<int> ladder;                 ///< one fit of M x M control points each
  bool open = false;                       ///< the data are an open surface with a rim (catmull-clark)
  double smoothness = 1.0;
  std::vector<std::string> write{"mesh", "model", "report"};
  MeshFormat mesh_format = MeshFormat::ply;
  std::optional<int> mesh_density;  ///< default: about 100,000 facets
  int threads = 0;
  bool overwrite = false;

  /// M of the fits of M x M control points that are asked for: the ladder, or 10, 20, 40, 80 up to a spline's detail.
  std::vector<int> rungs() const;
  bool writes(const std::string& kind) const;
  /// \throws SettingError with the key, its value and the rule. Does not look at any file.
  void validate() const;
};

const SettingTable<GeometryFitSettings>& geometry_fit_table();

}  // namespace pellicle
