#pragma once
/// Signs of determinants of doubles, exact: a filter first, expansions where it cannot decide (the idea of J. R.
/// Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates", 1997; the code is our
/// own).

#include "pellicle/base/geometry.h"

namespace pellicle {

/// Sign of det(a-d, b-d, c-d): which side of the plane through a, b, c the point d lies on; 0 exactly on it.
/// \pre finite values whose products of three neither overflow nor underflow (sizes in mm never do).
int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Sign of the area of (a, b, c) seen along coordinate axis `drop` (0, 1, 2), which is left out. Exact.
int orientation_2d(const Vec3& a, const Vec3& b, const Vec3& c, int drop);

/// Whether two closed triangles have a point in common. Exact, coplanar triangles included. A triangle without area
/// counts through its edges.
bool triangles_meet(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b);

/// Whether the closed segment pq and the closed triangle have a point in common. Exact; false for a triangle without
/// area.
bool segment_meets_triangle(const Vec3& p, const Vec3& q, const std::array<Vec3, 3>& triangle);

}  // namespace pellicle
