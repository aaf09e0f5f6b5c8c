#pragma once
/// The closed set of surface models and what every one of them can do.

#include <array>
#include <compare>
#include <cstddef>
#include <string>
#include <variant>
#include <vector>

#include "pellicle/mesh/triangle_mesh.h"
#include "pellicle/surface/normal/normal_model.h"
#include "pellicle/surface/quad/catmull_clark_model.h"
#include "pellicle/surface/quad/slime_model.h"
#include "pellicle/surface/spline/spline_model.h"

namespace pellicle {

/// One class of models each. All have blocks(), reference() (parameters of the reference shape, see SampleLayout),
/// layout(level), evaluate(), pull_back(), refine(), base_facets() (triangles at level 0, about four times as many
/// per level), degrees_of_freedom(), refinements(), is_closed(), control_mesh(parameters) and name().
using SurfaceModel = std::variant<NormalModel, SplineModel, CatmullClarkModel, SlimeModel>;

/// The open ones (cylinder, rectangle) enclose no volume: a fit to an image refuses them.
enum class ModelKind { normal, spline, spline_torus, spline_cylinder, spline_rectangle, catmull_clark, slime };

/// Which model a fit starts with.
struct ModelChoice {
  ModelKind kind = ModelKind::normal;
  StartSolid solid = StartSolid::tetrahedron;      ///< normal
  SubdivisionRule rule = SubdivisionRule::smooth;  ///< normal
};
/// Of the fewest control points; its reference shape is the unit sphere about the origin (`spline_torus`: a torus of
/// major radius 1 and axis z).
SurfaceModel start_model(const ModelChoice& choice);

/// The image of the model's reference shape under x -> centre + A x: points centre + A p, vectors A v, normals
/// unit(A^-T n).
/// \throws BadData when the model has no reference shape.
Parameters affine_image(const SurfaceModel& model, const Vec3& centre, const Mat3& A);
/// The reference shape laid onto the ellipsoid centre + shape * (unit ball). Spheres: that ellipsoid, a spline's poles
/// on its longest axis. Torus: the affine image with the same second moments (of solids), its hole along the shortest
/// axis.
/// \throws BadData when the model has no reference shape.
Parameters on_ellipsoid(const SurfaceModel& model, const Vec3& centre, const Mat3& shape);

/// Brings control points and normals to the targets where the model has them on its surface: the normal model. Other
/// models keep their parameters.
/// \param targets one per sample of `layout`, a layout of the model with reference positions.
void place_on(const SurfaceModel& model, const SampleLayout& layout, const SampleTargets& targets,
              Parameters& parameters);

/// How much a given bending of the surface says about its control points, at most 1: facets of a normal-subdivision
/// surface bend between their control points wherever these are.
double bending_scale(const SurfaceModel& model);

/// A model and its unknowns: all that re-creates the surface exactly.
struct Surface {
  SurfaceModel model;
  Parameters parameters;
};

std::vector<BlockKind> blocks_of(const SurfaceModel& model);
int control_point_count(const SurfaceModel& model);
int base_facets(const SurfaceModel& model);
int degrees_of_freedom(const SurfaceModel& model);
/// How often a start model was refined to have about so many control points.
int refinements_of(const SurfaceModel& model);
bool is_closed(const SurfaceModel& model);
SampleLayout layout_of(const SurfaceModel& model, int level);
/// All that a sample layout depends on: models with equal keys have equal layouts.
struct LayoutKey {
  std::size_t kind = 0;  ///< alternative of SurfaceModel
  int variant = 0;       ///< normal: subdivision rule; spline: generator
  int level = 0;
  std::vector<std::array<int, 3>> control_facets;
  Parameters reference;  ///< empty when the model has no reference shape
  auto operator<=>(const LayoutKey&) const = default;
};
LayoutKey layout_key(const SurfaceModel& model, int level);
/// Samples that see every motion of the control points, even where these crowd (a spline's poles): about four per
/// control point at level 1, four times as many per level. Otherwise as layout_of.
SampleLayout knot_layout_of(const SurfaceModel& model, int level);
void evaluate(const SurfaceModel& model, const Parameters& parameters, const SampleLayout& layout, bool with_jacobian,
              SurfaceSamples& samples);
void pull_back(const SurfaceModel& model, const Parameters& parameters, const SampleLayout& layout,
               const std::vector<Vec3>& dE_dx, std::vector<double>& gradient);
Surface refine(const Surface& surface);
/// The same surface with its present shape as the reference, so that smoothness is measured against it. A spline, whose
/// poles belong to its reference, keeps the one it has.
Surface at_rest(const Surface& surface);
/// Mesh with limit normals, closed when the model is, 2^level intervals along a control edge.
TriangleMesh tessellate(const Surface& surface, int level);
/// The level at which facet edges are about `edge_mm` long (root mean square) or shorter, at most 7.
int tessellation_level(const Surface& surface, double edge_mm);
/// The level at which facet edges are about a hundredth of the object or shorter, 2 to 6: for meshes to look at.
int viewing_level(const Surface& surface);
/// The control mesh itself: control points, joined by facets, with normals where the model has them.
TriangleMesh control_mesh_of(const Surface& surface);
std::string model_name(const SurfaceModel& model);  ///< "normal", "spline", "spline-torus" ...

}  // namespace pellicle
