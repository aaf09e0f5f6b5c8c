#pragma once
/// Where scattered points of a surface end.

#include <vector>

#include "pellicle/mesh/point_tree.h"

namespace pellicle {

/// Unit normal of the plane through each point's 12 nearest neighbours (least squares); the side is not known.
std::vector<Vec3> plane_normals(const PointTree& tree);

/// The points on the rim of an open surface: seen along the normal, the 24 nearest neighbours leave a gap of more than
/// 0.8 pi (half a turn on a straight rim; by chance inside of it, once in 5000), and three or more of these neighbours
/// are such points too. \param normals of plane_normals. None for a closed surface.
std::vector<Vec3> rim_of(const PointTree& tree, const std::vector<Vec3>& normals);

}  // namespace pellicle
