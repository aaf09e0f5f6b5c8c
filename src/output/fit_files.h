#pragma once
/// A fit to geometry with files at both ends: points, a mesh or a mask to a surface, its model and a report.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "pellicle/base/observer.h"
#include "pellicle/job/fit_geometry.h"
#include "pellicle/mesh/files/mesh_file.h"
#include "pellicle/output/run_record.h"

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
  /// \throws UsageError naming the flag, its value and the rule.
  void validate() const;
};

struct GeometryFitResult {
  GeometryFitSettings settings;
  std::filesystem::path file;  ///< of settings.input, without a label
  GeometryInput input;
  GeometryFit fit;
  std::vector<InputFile> inputs;
  std::vector<OutputFile> outputs;
  PhaseSeconds seconds;
  int exit_code() const;  ///< 3 when a fit that was asked for is not ok
};

/// \throws what read_geometry and the writers throw; UsageError; CannotCreate before any work; Interrupted.
GeometryFitResult fit_to_files(const GeometryFitSettings& settings, const RunRecord& record, const Observer& observer);

GeometryFitOptions options_of(const GeometryFitSettings& settings);

/// Size, control points, rms and max in mm and %, genus, self-intersections, status, seconds; and the heading.
std::string heading_of_fits();
std::string line_of(const FittedSurface& fitted, double diameter);

}  // namespace pellicle
