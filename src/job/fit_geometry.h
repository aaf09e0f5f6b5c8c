#pragma once
/// Fitting a surface to points, a mesh or a mask in memory, and measuring it.

#include <optional>

#include "pellicle/base/phase_clock.h"
#include "pellicle/fit/geometry/size_search.h"
#include "pellicle/mesh/measure.h"

namespace pellicle {

struct GeometryFitOptions {
  SizeOptions sizes = {};
  std::optional<int> mesh_level = {};  ///< 2^level facets along a control edge; default: about 100,000 facets
};

struct GeometryFit {
  SizeSearch sizes;
  TriangleMesh mesh;  ///< of the chosen surface; outward when it is closed, LPS mm
  MeshTopology topology;
  double volume_ml = 0.0;  ///< of the smooth surface; not a number: it is open
  double area_mm2 = 0.0;
  PhaseSeconds seconds;  ///< wall time of "fit" and "measure"
};

/// \pre takes(options.sizes.model.kind, input).
/// \throws as search_size.
GeometryFit fit_geometry(const GeometryInput& input, const GeometryFitOptions& options = {},
                         const Observer& observer = {});

}  // namespace pellicle
