#pragma once
/// The solid that scattered points of a closed surface outline, at their own resolution.

#include "pellicle/image/image.h"

namespace pellicle {

/// All that balls of radius r cannot reach from outside without touching a point (the closing of the points by that
/// ball, an alpha shape's solid), on a grid of a third of the mean gap between the points in the axes of the world, r
/// the smallest of 1, 1.25, 1.6 and 2 gaps that leaves no leak: 0.6 or more of the largest volume of the four. Between
/// points it dips inward, so that the solid lies inside: of 300 points strewn over a ball it has four fifths of the
/// volume, and springs that draw a surface outward do not mistake one wall for the other. The largest part.
/// \throws
/// BadData when nothing is enclosed.
Image<std::uint8_t> mask_of_points(const std::vector<Vec3>& points);

}  // namespace pellicle
