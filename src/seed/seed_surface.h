#pragma once
/// Start surfaces from a quad mesh, such as the boundary of voxels: each model of any topology and the normal model.

#include <optional>
#include <utility>

#include "pellicle/mesh/quad/quad_mesh.h"
#include "pellicle/surface/surface.h"

namespace pellicle {

/// Vertices moved half way to the mean of their neighbours and then outward, all by the same amount, until the volume
/// is what it was: steps as of voxels vanish, the size stays.
std::vector<Vec3> smoothed_vertices(const QuadMesh& mesh, int sweeps);

/// Control points whose surface passes near the targets: c += target - (surface at each vertex), 20 times.
/// Approximating surfaces shrink otherwise.
/// \param limit the surface at each control vertex.
std::vector<Vec3> compensated(const PointRows& limit, const std::vector<Vec3>& target);

/// The smoothed mesh as a surface; reference shape: the same, smoothed more.
/// \throws BadData for a faulty mesh.
std::pair<CatmullClarkModel, Parameters> catmull_clark_seed(const QuadMesh& mesh);
std::pair<SlimeModel, Parameters> slime_seed(const QuadMesh& mesh);
/// Points and normals are those of the Catmull-Clark surface at its control vertices; each quad is split along the
/// diagonal whose ends' normals agree better. The triangles are right-angled, where only the `smooth` rule is
/// normal-continuous.
std::pair<NormalModel, Parameters> normal_seed(const QuadMesh& mesh, SubdivisionRule rule = SubdivisionRule::smooth);

/// The one of these that is chosen; none for splines, whose topology is fixed.
std::optional<Surface> seed_surface(const QuadMesh& mesh, const ModelChoice& choice);

}  // namespace pellicle
