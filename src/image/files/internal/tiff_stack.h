#pragma once
/// Multi-page TIFF as a volume: one page per slice, 8, 16, 32 or 64 bit integers or floats, strips or tiles, any
/// compression of libtiff. Index axes lie along LPS, origin 0: a TIFF has no place in a patient.

#include <filesystem>

#include "pellicle/image/files/internal/voxel_source.h"

namespace pellicle {

/// Spacing: from OME-XML or ImageJ's description (tiff_spacing.h). Where z or x and y are
/// missing 1 mm is assumed with a warning that begins with "NO SPACING" and spacing_known is false.
/// \throws BadData: single page (2D), RGB, complex, pages that differ, more than one channel or time point.
VolumeSource open_tiff_stack(const std::filesystem::path& path);

}  // namespace pellicle
