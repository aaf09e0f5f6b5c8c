#pragma once
/// `pellicle fit`: geometry from file to fitted surface, model, report.

#include <string>
#include <vector>

#include "pellicle/base/observer.h"
#include "pellicle/base/phase_clock.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/output/geometry_input.h"
#include "pellicle/output/run_record.h"
#include "pellicle/settings/geometry_fit_settings.h"

namespace pellicle {

/// Status of one fit: "ok", "folded" (it cuts itself), "tolerance_missed".
struct FittedSurface {
  std::string name;  ///< "10 x 10" for a spline, "34 points" otherwise
  PointFit fit;
  std::string status, reason;
};

struct GeometryFitResult {
  GeometryFitSettings settings;
  GeometryInput input;
  std::vector<FittedSurface> tried;  ///< all levels, in order
  std::size_t chosen = 0;            ///< the one that is written
  double stretch = 0.0;              ///< of the spherical map, 0: none was needed
  TriangleMesh mesh;
  MeshTopology topology;
  double volume_ml = 0.0;  ///< not a number: the surface is open
  double area_mm2 = 0.0;
  std::vector<InputFile> inputs;
  std::vector<OutputFile> outputs;
  PhaseSeconds seconds;
  int exit_code() const;  ///< 3 when a fit that was asked for is not ok
};

/// \throws what read_geometry and the writers throw; UsageError; CannotCreate before any work; Interrupted.
GeometryFitResult fit_to_files(const GeometryFitSettings& settings, const RunRecord& record, const Observer& observer);

/// Size, control points, rms and max in mm and %, genus, self-intersections, status, seconds; and the heading.
std::string heading_of_fits();
std::string line_of(const FittedSurface& fitted, double diameter);

}  // namespace pellicle
