#pragma once
/// Start surfaces from a quad mesh, such as the boundary of voxels: each model of any topology and the normal model.

#include <utility>

#include "pellicle/mesh/quad_mesh.h"
#include "pellicle/surface/catmull_clark_model.h"
#include "pellicle/surface/normal_model.h"
#include "pellicle/surface/slime_model.h"

namespace pellicle {

/// Vertices moved half way to the mean of their neighbours and then outward, all by the same amount, until the volume
/// is what it was: steps as of voxels vanish, the size stays.
std::vector<Vec3> smoothed_vertices(const QuadMesh& mesh, int sweeps);

/// Control points whose surface passes near the targets: c += target - (surface at each vertex), 20 times.
/// Approximating surfaces shrink otherwise. \param limit the surface at each control vertex.
std::vector<Vec3> compensated(const PointRows& limit, const std::vector<Vec3>& target);

/// The smoothed mesh as a surface; reference shape: the same, smoothed more. \throws BadData for a faulty mesh.
std::pair<CatmullClarkModel, Parameters> catmull_clark_seed(const QuadMesh& mesh);
std::pair<SlimeModel, Parameters> slime_seed(const QuadMesh& mesh);
/// Points and normals are those of the Catmull-Clark surface at its control vertices; each quad is split along the
/// diagonal whose ends' normals agree better. (The `smooth` rule: the triangles are right-angled, where the others are
/// not normal-continuous.)
std::pair<NormalModel, Parameters> normal_seed(const QuadMesh& mesh);

}  // namespace pellicle
