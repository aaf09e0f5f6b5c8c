#pragma once
/// Growing, shrinking and filling of masks. For this folder's sources only.

#include <cstdint>
#include <vector>

#include "pellicle/image/image.h"

namespace pellicle {

/// `steps` times the largest (grow) or smallest value of the 27 voxels around each; beyond the border counts as 0.
void grow_or_shrink(Image<std::uint8_t>& mask, int steps, bool grow);
/// What no path from the corner reaches becomes 1. \pre the border is empty.
void fill_cavities(Image<std::uint8_t>& mask);
/// Keeps the largest part only (joined by faces); returns its voxels.
std::size_t keep_largest(Image<std::uint8_t>& mask);
/// Joins parts of `least` voxels or more to the largest, each along the path on which `field`, of the mask's size,
/// falls short of one half the least, the path's voxels and their neighbours by faces filled; parts that are farther
/// than about three voxels of field 0, and smaller ones, vanish.
void join_parts(Image<std::uint8_t>& mask, const Image<float>& field, std::size_t least);
/// Voxels of edge `h` that hold points, with an empty margin of so many voxels about the box from lo to hi.
Image<std::uint8_t> occupied_voxels(const std::vector<Vec3>& points, const Vec3& lo, const Vec3& hi, double h,
                                    int margin);

}  // namespace pellicle
