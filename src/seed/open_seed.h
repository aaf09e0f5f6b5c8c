#pragma once
/// Start surface with a border: the part of a closed start mesh that is near the data.

#include <utility>

#include "pellicle/image/image.h"
#include "pellicle/mesh/points/point_tree.h"
#include "pellicle/mesh/points/rim.h"
#include "pellicle/mesh/quad/quad_mesh.h"
#include "pellicle/surface/quad/catmull_clark_model.h"

namespace pellicle {

/// Points of an open surface and the unit normals of the planes through their neighbours, side unknown.
struct OpenPoints {
  const PointTree& tree;
  std::vector<Vec3> plane_normals;
};

/// The part of a closed mesh (smoothed) that lies along the points: quads whose centres are within `reach` of a point
/// and that are parallel to its plane. Holes of fewer than four quads stay filled. The largest part is kept, without
/// quads that hang by one edge and vertices that join two fans. A strip of quads is added around it, so that every
/// border vertex has two quads and the border of the limit surface is a smooth curve.
/// \throws BadData when nothing of the mesh is near the points.
QuadMesh open_part(const QuadMesh& closed, const OpenPoints& points, double reach);

/// Smooth curves along the rims of the points, one per border of open_part. Five grids over the body are tried, each
/// finer by a root of two; the curves that lie nearest to the rim points are taken. Empty when there is no rim.
/// \param body the points filled up to their mouths (raster/cup.h).
std::vector<RimCurve> rims_of(const Image<std::uint8_t>& body, const OpenPoints& points);

/// Points that close the openings: on lines from the rims to their middles, `spacing` mm apart and from the rims.
std::vector<Vec3> lids_of(const std::vector<RimCurve>& rims, double spacing);

/// The same part without what is nearer to the points of lids_of. Its border vertices lie on the rims at equal
/// distances; the vertices between are spread along the points, so that steps of voxels vanish.
QuadMesh open_part_within(const QuadMesh& closed, const OpenPoints& points, const std::vector<RimCurve>& rims,
                          double reach);

/// The Catmull-Clark surface whose control vertices' limits are the vertices of open_part_within.
std::pair<CatmullClarkModel, Parameters> open_seed(const QuadMesh& closed, const OpenPoints& points,
                                                   const std::vector<RimCurve>& rims, double reach);

}  // namespace pellicle
