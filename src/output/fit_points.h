#pragma once
/// `pellicle fit`: geometry from file to fitted surface, model, report.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "pellicle/base/observer.h"
#include "pellicle/base/phase_clock.h"
#include "pellicle/mesh/files/mesh_file.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/output/geometry_input.h"
#include "pellicle/output/run_record.h"

namespace pellicle {

/// Which residual the tolerance is about.
enum class ToleranceOf { rms, p95, max };

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

  static constexpr int kFirstRung = 10;
  /// M of the fits of M x M control points that are asked for: the ladder, or 10, 20, 40, 80 up to a spline's detail.
  std::vector<int> rungs() const;
  bool writes(const std::string& kind) const;
  /// \throws UsageError naming the flag, its value and the rule.
  void validate() const;
};

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
