#pragma once
/// NIfTI-1, NIfTI-2 and Analyze 7.5, single file or header/image pair, gzipped or not, either byte order.
///
/// Where the voxels are. The header offers up to two placements; the choice is ITK's, so that results lie where
/// 3D Slicer and ITK-SNAP draw the image:
///  - one of sform and qform known (code > 0): that one;
///  - both known: the sform, unless its code is not 1 (scanner) and the two differ, then the qform, with a warning
///    that says by how much (an sform of code 2..4 is often a registration result, an affine map that is not a grid);
///  - an sform that is singular or sheared gives way to a known qform, with a warning; without one it is an error;
///  - neither known, or Analyze: index axes along LPS with pixdim as spacing, origin 0, with a warning.
/// A sform that is slightly off orthogonal is read with the nearest rotation (affine_grid.h). pixdim and sform are in
/// the unit of xyzt_units (m, mm, um; unknown counts as mm). Analyze knows no value scaling.

#include <filesystem>
#include <optional>

#include "pellicle/image/files/internal/voxel_source.h"

namespace pellicle {

/// \param frame of a time series; without one a file of several volumes is refused.
/// \throws NoInput, BadData, as read_volume.
VolumeSource open_nifti(const std::filesystem::path& path, std::optional<int> frame);

}  // namespace pellicle
