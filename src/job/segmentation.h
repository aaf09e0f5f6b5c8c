#pragma once
/// What a segmentation gives: fitted surfaces, what was measured on each, and maps of all on the voxel grid.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pellicle/base/phase_clock.h"
#include "pellicle/fit/fit_types.h"
#include "pellicle/image/image.h"
#include "pellicle/mesh/measure.h"

namespace pellicle {

/// Figures of each of many objects beside those of a single one.
struct ObjectShape {
  Vec3 centre{0, 0, 0};     ///< centroid of the solid, LPS mm
  double sphericity = 0.0;  ///< area of the ball of equal volume over the area; 1 for a ball
  double elongation = 0.0;  ///< longest over shortest axis of the ellipsoid of inertia
  double visible = 1.0;     ///< fraction of the surface that lies in the image
  double support = 0.0;     ///< fall of the intensity across the surface over the contrast, 0..1
  double limited = 0.0;     ///< fraction of the visible surface at a neighbour's territory
};

/// How many objects were looked for.
struct ManySummary {
  double radius_mm = 0.0;  ///< typical, as estimated or given; 0: nothing found
  bool dark = false;
  std::size_t seeds = 0, weak = 0, doubled = 0;  ///< places tried; turned down; parts of another object
  double variation = 1.0;                        ///< how uneven the objects are inside (docs/nuclei.md)
  bool typical_shape = false;                    ///< fitted towards their own typical shape
  double z_extent = 0.0;                         ///< mean extent along z over that in x and y, of whole objects
};

/// One fitted object and what was measured on it.
struct ObjectResult {
  int label = 1;
  std::string name;
  Surface surface;
  FitSummary fit = {};
  std::vector<TraceFrame> trace = {};  ///< when the options ask for it
  TriangleMesh mesh = {};              ///< as it is written: closed, outward, LPS mm
  int mesh_level = 0;                  ///< 2^level facets along a control edge
  MeshTopology topology = {};
  std::size_t self_intersections = 0;
  double volume_surface_ml = 0.0;  ///< of the smooth surface
  double volume_mask_ml = 0.0;     ///< of the marked voxels
  /// Of OpenVDB's own mask, inside the image; none where it was not computed.
  std::optional<double> volume_openvdb_ml = {};
  /// Of the facets of `mesh`, what lies outside the image included.
  std::optional<double> volume_mesh_ml = {};
  double volume_partial_ml = 0.0;  ///< of the partial-volume map, inside the image
  double area_mm2 = 0.0;
  bool touches_border = false;     ///< marked voxels on the border of the volume
  std::size_t overlap_voxels = 0;  ///< voxels that other objects claim too
  double seconds = 0.0;
  std::optional<ObjectShape> shape = {};  ///< of many objects
};

/// The result of one volume.
struct Segmentation {
  std::vector<ObjectResult> objects;
  std::optional<ManySummary> many = {};    ///< when many objects were looked for
  Image<std::uint16_t> labels = {};        ///< label of the object at each voxel, 0: none
  Image<float> fraction = {};              ///< inside fraction of each voxel, 0..1; empty unless asked for
  Image<float> distance = {};              ///< mm to the nearest surface, negative inside; empty unless asked for
  Image<float> image = {};                 ///< the volume as it was fitted, in LPS order; empty unless asked for
  std::vector<std::string> warnings = {};  ///< one sentence each, for the user
  PhaseSeconds seconds = {};               ///< wall time of "fit", "measure" and, of single objects, "rasterise"

  /// Whether every object passed its own checks.
  bool all_ok() const;
};

}  // namespace pellicle
