#pragma once
/// Where scattered points of a surface end.

#include <memory>
#include <vector>

#include "pellicle/mesh/point_tree.h"

namespace pellicle {

/// The plane next to some points (least squares).
struct Plane {
  Vec3 mean = Vec3::Zero(), normal = Vec3::Zero();  ///< a unit normal, the side is not known
  double deviation = 0.0;                           ///< mm, rms of the points from it
};
/// \pre at least one point.
Plane plane_through(const std::vector<Vec3>& points);

/// Unit normal of the plane through each point's 12 nearest neighbours (least squares); the side is not known.
std::vector<Vec3> plane_normals(const PointTree& tree);

/// Points on the rim of an open surface.
struct RimPoints {
  std::vector<Vec3> x;
  std::vector<Vec3> outward;  ///< unit vectors along the surface, away from the points
};

/// Seen along the normal, the 24 nearest neighbours of a rim point leave a gap of more than 0.65 pi (half a turn on a
/// straight rim), and of them and itself five or more do so and two leave one of more than 0.75 pi (by chance inside of
/// it, once in 2000). \param normals of plane_normals. None for a closed surface.
RimPoints rim_of(const PointTree& tree, const std::vector<Vec3>& normals);

/// A smooth closed curve along a rim, as a dense polyline.
struct RimCurve {
  std::vector<Vec3> x;
  std::vector<Vec3> tangent;  ///< unit vectors, the way round of the start
  std::vector<Vec3> outward;  ///< unit vectors along the surface and across the curve
  int points = 0;             ///< of the rim that tell where it runs
};

/// Least squares by a periodic cubic B-spline, coarse to fine, of as many control points as the points give ground for
/// (Schwarz's criterion; far points count less). The points of a rim lie inside of it: at last those beyond the curve
/// count 20 times as much, so it runs along the outermost, and points far off count for nothing. Every point belongs to
/// the curve whose start is nearest. \param starts closed polylines near the rims. Curves with fewer than 12 points of
/// their own are left out.
std::vector<RimCurve> rim_curves(const std::vector<std::vector<Vec3>>& starts, const RimPoints& rim);

/// Places at even shares of the length of a closed polyline.
std::vector<Vec3> evenly_along(const std::vector<Vec3>& loop, int count);

/// The nearest place of some curves.
class RimLocator {
 public:
  explicit RimLocator(const std::vector<RimCurve>& curves);
  struct Place {
    Vec3 x = Vec3::Zero(), tangent = Vec3::Zero(), outward = Vec3::Zero();
    int curve = -1;
    double along = 0.0;     ///< share of the curve's parameter, in [0, 1)
    double distance = 0.0;  ///< mm
  };
  Place nearest(const Vec3& x) const;

 private:
  std::vector<RimCurve> curves_;
  std::vector<std::pair<int, int>> owner_;  ///< curve and sample of each point of the tree
  std::unique_ptr<PointTree> tree_;
};

}  // namespace pellicle
