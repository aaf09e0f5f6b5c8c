#pragma once
/// The rim of an open surface that is given by scattered points: which points lie on it, and smooth curves along it.

#include <memory>
#include <vector>

#include "pellicle/mesh/points/point_tree.h"

namespace pellicle {

/// The plane nearest to some points (least squares).
struct FittedPlane {
  Vec3 mean = Vec3::Zero(), normal = Vec3::Zero();  ///< a unit normal, the side is not known
  double deviation = 0.0;                           ///< mm, rms of the points from it
};
/// \pre at least one point.
FittedPlane plane_through(const std::vector<Vec3>& points);

/// Unit normal of the plane through each point's 12 nearest neighbours (least squares); the side is not known.
std::vector<Vec3> plane_normals(const PointTree& tree);

/// Points on the rim of an open surface.
struct RimPoints {
  std::vector<Vec3> x;
  std::vector<Vec3> outward;  ///< unit vectors along the surface, away from the points
};

/// The points on the rim. A point may be one where its 24 nearest neighbours, seen along the normal, leave an angle of
/// more than 0.65 pi empty (on a straight rim: pi). It is one when five or more of these neighbours and itself do so,
/// and two or more leave more than 0.75 pi empty. A point inside of the surface does so by chance once in 2000.
/// \param normals of plane_normals.
/// \return none for a closed surface.
RimPoints rim_of(const PointTree& tree, const std::vector<Vec3>& normals);

/// A smooth closed curve along a rim, as a dense polyline.
struct RimCurve {
  std::vector<Vec3> x;
  std::vector<Vec3> tangent;  ///< unit vectors, the way round of the start
  std::vector<Vec3> outward;  ///< unit vectors along the surface and across the curve
  int points = 0;             ///< of the rim that the curve was fitted to
};

/// Periodic cubic B-splines through the rim points by least squares, coarse to fine. Schwarz's criterion chooses the
/// number of control points; points far away count less. Rim points lie inside of the rim: in the last rounds points
/// beyond the curve count 20 times as much, so that it runs along the outermost ones, and points far away do not count.
/// Every point belongs to the curve whose start is nearest.
/// \param starts closed polylines near the rims.
/// \return curves with 12 points of their own or more.
std::vector<RimCurve> rim_curves(const std::vector<std::vector<Vec3>>& starts, const RimPoints& rim);

/// Points at equal distances along a closed polyline.
std::vector<Vec3> evenly_along(const std::vector<Vec3>& loop, int count);

/// The nearest place of some curves.
class RimLocator {
 public:
  explicit RimLocator(const std::vector<RimCurve>& curves);
  struct Place {
    Vec3 x = Vec3::Zero(), tangent = Vec3::Zero(), outward = Vec3::Zero();
    int curve = -1;
    double along = 0.0;     ///< the curve's parameter, in [0, 1)
    double distance = 0.0;  ///< mm
  };
  Place nearest(const Vec3& x) const;

 private:
  std::vector<RimCurve> curves_;
  std::vector<std::pair<int, int>> owner_;  ///< curve and sample of each point of the tree
  std::unique_ptr<PointTree> tree_;
};

}  // namespace pellicle
