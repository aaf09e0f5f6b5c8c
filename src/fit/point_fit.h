#pragma once
/// Fitting a surface to geometry: points or a closed surface, no image.

#include <optional>
#include <string>
#include <vector>

#include "pellicle/base/observer.h"
#include "pellicle/fit/fit.h"
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
/// A closed surface as data: itself, turned outward, and `samples` points spread over it, with its normals.
GeometryData data_of(TriangleMesh surface, int samples);
/// Largest distance between two points (extremes along 200 directions), mm. 0 for fewer than two.
double diameter_of(const std::vector<Vec3>& points);

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
  /// Fraction of noisy points that lie beside the surface together with their neighbours, on one side, further than noise
  /// puts them (five robust deviations, one per cent of the diameter): a part that the surface does not show.
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

/// Places the reference shape so that a model of few control points follows the map best: for the spline this says
/// where the poles go. \param probe a model of the kind that will be fitted, with about a hundred control points.
Correspondence choose_axis(const SphereMap& map, const SurfaceModel& probe);

/// Fits a model from scratch: least squares to the places that the correspondence names, then springs, attached anew
/// until the residual stops falling. \param hold_out every tenth point takes no part; its residual is in the summary.
/// \throws BadData when model and data do not fit together (no reference shape); Interrupted.
PointFit fit_to_map(const SurfaceModel& model, const GeometryData& data, const Correspondence& correspondence,
                    const PointFitSettings& settings, bool hold_out, const Observer& observer = {});
/// The same for a surface that is near the data already.
PointFit fit_from(const Surface& start, const GeometryData& data, const PointFitSettings& settings, bool hold_out,
                  const Observer& observer = {});

/// Residuals both ways and self-intersections, measured on a dense mesh of the surface.
void measure_fit(const GeometryData& data, PointFit& fit);
/// The mesh that measure_fit looks at: 10,000 facets and 30 a control point or more, at most 250,000.
int measuring_level(const SurfaceModel& model);
TriangleMesh measuring_mesh(const Surface& surface);

}  // namespace pellicle
