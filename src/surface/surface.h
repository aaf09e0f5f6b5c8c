#pragma once
/// The closed set of surface models and what every one of them can do.

#include <string>
#include <variant>

#include "pellicle/mesh/triangle_mesh.h"
#include "pellicle/surface/normal_model.h"

namespace pellicle {

using SurfaceModel = std::variant<NormalModel>;

/// A model and its unknowns: all that re-creates the surface exactly.
struct Surface {
  SurfaceModel model;
  Parameters parameters;
};

std::vector<BlockKind> blocks_of(const SurfaceModel& model);
int control_point_count(const SurfaceModel& model);
int degrees_of_freedom(const SurfaceModel& model);
SampleLayout layout_of(const SurfaceModel& model, int level);
void evaluate(const SurfaceModel& model, const Parameters& parameters, const SampleLayout& layout, bool with_jacobian,
              SurfaceSamples& samples);
void pull_back(const SurfaceModel& model, const Parameters& parameters, const SampleLayout& layout,
               const std::vector<Vec3>& dE_dx, std::vector<double>& gradient);
Surface refine(const Surface& surface);
/// Closed mesh with limit normals, 2^level intervals along a control edge.
TriangleMesh tessellate(const Surface& surface, int level);
/// The level at which facet edges are about `edge_mm` long (root mean square) or shorter, at most 7.
int tessellation_level(const Surface& surface, double edge_mm);
/// The control mesh itself (points and normals; facets are the control triangles).
TriangleMesh control_mesh_of(const Surface& surface);
std::string model_name(const SurfaceModel& model);  ///< "normal", ...

}  // namespace pellicle
