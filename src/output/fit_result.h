#pragma once
/// What a fit to geometry with files at both ends gives, and how it is printed.

#include <filesystem>
#include <string>
#include <vector>

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

/// Lines of a table: size, control points, rms and max in mm and %, genus, self-intersections, status, seconds.
std::string heading_of_fits();
std::string line_of(const FittedSurface& fitted, double diameter);

}  // namespace pellicle
