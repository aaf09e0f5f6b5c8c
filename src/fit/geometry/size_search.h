#pragma once
/// Fitting a surface to geometry with as many control points as it takes: the search over the sizes of a model.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "pellicle/base/observer.h"
#include "pellicle/fit/geometry/geometry_input.h"

namespace pellicle {

/// Which residual, data to surface, a tolerance is about.
enum class ToleranceOf { rms, p95, max };

/// Which sizes are tried: those of the ladder, one size, one detail, the fewest control points for a tolerance or, when
/// none of these is given, as many as points that are left out of the fit are predicted better by.
struct SizeOptions {
  ModelChoice model = {};
  /// Refinements of the start model; with a tolerance: at most.
  std::optional<int> detail = {};
  std::optional<double> tolerance_mm = {}, tolerance_percent = {};  ///< the second of the diameter
  ToleranceOf tolerance_of = ToleranceOf::rms;
  std::optional<std::array<int, 2>> size = {};  ///< M1, M2 of a spline
  std::vector<int> ladder = {};                 ///< one fit of M x M control points each, of a spline
  double smoothness = 1.0;                      ///< factor of the bending energy

  static constexpr int kFirstRung = 10;  ///< M of a spline of detail 0, doubled with each detail
};

enum class SizeStatus {
  ok,
  doubtful,          ///< points lie together beside the surface
  folded,            ///< it cuts itself
  tolerance_missed,  ///< the residual is above the tolerance
};
std::string to_string(SizeStatus status);

struct FittedSurface {
  std::string name;  ///< "10 x 10" for a spline, "34 points" otherwise
  PointFit fit;
  SizeStatus status = SizeStatus::ok;
  std::string reason = {};  ///< one sentence for the status
};

struct SizeSearch {
  std::vector<FittedSurface> tried;        ///< all sizes, in order
  std::size_t chosen = 0;                  ///< the one to keep
  double stretch = 0.0;                    ///< of the spherical map, 0: none was needed
  std::vector<std::string> warnings = {};  ///< one sentence each, for the user

  const FittedSurface& best() const { return tried[chosen]; }
};

/// Whether surfaces of this kind can be fitted to such data: splines to grids; normal, spline, Catmull-Clark and slime
/// surfaces to everything else.
bool takes(ModelKind kind, const GeometryInput& input);

/// \pre takes(options.model.kind, input).
/// \throws BadData when no surface of this kind can start near the data; Interrupted.
SizeSearch search_size(const GeometryInput& input, const SizeOptions& options, const Observer& observer = {});

}  // namespace pellicle
