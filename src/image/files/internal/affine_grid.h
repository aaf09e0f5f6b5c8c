#pragma once
/// From the affine map in a file's header to a grid: spacing, direction, origin.

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "pellicle/image/image_grid.h"

namespace pellicle {

/// Largest departure of two index axes from a right angle, degrees. NaN for a singular matrix.
double skew_degrees(const Mat3& world_from_index);

/// The orthogonal matrix nearest to `m` in the Frobenius norm, determinant of the same sign: the orthogonal factor of
/// the polar decomposition by Newton's iteration (Higham, SIAM J. Sci. Stat. Comput. 7, 1986). Signed permutations
/// come back unchanged bit for bit.
/// \pre m is not singular.
Mat3 nearest_rotation(const Mat3& m);

/// Splits `world_from_index` (LPS mm) into spacing (column lengths) and direction. Columns that are not quite
/// orthogonal (rounded header, resampled scan) are replaced by the nearest rotation; above 0.01 degree a warning says
/// by how much. Above 1 degree it is shear and refused: replacing it would move the far corner of a 256-voxel volume by
/// more than two voxels.
/// \throws BadData: shear, singular or non-finite
/// matrix.
ImageGrid grid_from_affine(const std::filesystem::path& path, const Index3& size, const Mat3& world_from_index,
                           const Vec3& origin_in_world, std::vector<std::string>& warnings);

inline constexpr double max_skew_degrees = 1.0;

}  // namespace pellicle
