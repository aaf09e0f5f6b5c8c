#pragma once
/// What a surface is fitted to when there is no image, and what such a fit gives.

#include <optional>
#include <string>
#include <vector>

#include "pellicle/mesh/points/rim.h"
#include "pellicle/mesh/sphere/sphere_map.h"
#include "pellicle/surface/surface.h"

namespace pellicle {

/// What is fitted to, LPS mm.
struct GeometryData {
  std::vector<Vec3> points;
  std::vector<Vec3> normals;            ///< outward, one per point (zero: not known); empty: none is known
  std::vector<double> weights;          ///< one per point, >= 0; empty: 1 each
  std::optional<TriangleMesh> surface;  ///< closed and outward when the data are one: samples are pulled to it as well
  std::vector<RimCurve> rim;            ///< where an open surface ends; empty: it is closed
  bool robust = true;                   ///< points far off are outliers
  double diameter = 0.0;                ///< mm, see diameter_of
};

/// A first guess which place of the data belongs to which place of the reference shape. Known for spheres
/// (mesh/sphere/sphere_map.h); a model that starts near the data needs none.
struct Correspondence {
  SphereMap map;
  Mat3 map_from_reference = Mat3::Identity();  ///< a rotation: where the reference shape's axes lie on the map
};

struct PointFitSettings {
  int max_steps = 25;          ///< springs attached anew so often at most, a level
  double smoothness = 1.0;     ///< factor of the bending energy
  double improvement = 0.005;  ///< a level ends when a step gains less, as a fraction of the residual
  /// mm: points further off count more and more until none is, as far as the model can; of data without outliers
  /// (GeometryData::robust). Not set: least squares.
  std::optional<double> largest_residual = {};
};

/// Residuals in mm; of the data to the surface (`to_surface`), of the surface to the data.
struct Residual {
  double rms = 0.0, p95 = 0.0, max = 0.0;
};
struct PointFitSummary {
  int control_points = 0, degrees_of_freedom = 0, steps = 0, solver_iterations = 0;
  std::string reason;          ///< "converged", "step limit", ...
  double held_out_rms = -1.0;  ///< mm, of the points left out; -1: none were
  Residual to_surface, to_data;
  double inlier_rms = 0.0;  ///< mm, data to surface, robust weights
  /// Fraction of noisy points that lie beside the surface together with their neighbours, on one side, further than
  /// noise puts them (five robust deviations, one per cent of the diameter): a part that the surface does not show.
  double astray_share = 0.0;
  std::size_t self_intersections = 0;
  int genus = 0;         ///< border loops, if any, thought closed by discs
  int border_loops = 0;  ///< 0: closed
  double seconds = 0.0;
};
struct PointFit {
  Surface surface;
  PointFitSummary summary;
};

}  // namespace pellicle
