#pragma once
/// A fit to geometry with files at both ends: points, a mesh or a mask to a surface, its model and a report.

#include <string>
#include <vector>

#include "pellicle/base/observer.h"
#include "pellicle/job/fit_geometry.h"
#include "pellicle/output/run_record.h"
#include "pellicle/settings/geometry_fit_settings.h"

namespace pellicle {

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
