#pragma once
/// DICOM: a folder that holds one series of single-slice images, ordered by position along the normal of the slices.

#include <filesystem>

#include "pellicle/image/files/internal/voxel_source.h"

namespace pellicle {

/// Every file of the folder (not of folders in it) that is DICOM is looked at; files of other kinds are ignored, with
/// a warning. Rescale slope and intercept are applied per slice. The grid's axes: columns, rows, slices in the
/// direction of the normal (row direction x column direction), so that the determinant is +1.
/// \throws BadData: no DICOM file, mixed series or orientations or sizes, missing or doubled positions, uneven gaps,
///         a tilted gantry (shear), multi-frame, segmentation or other objects that are not image slices, RGB.
VolumeSource open_dicom_series(const std::filesystem::path& folder);

/// A single file is one slice, or an object that is not a volume: an error that says which, and what to give instead.
[[noreturn]] VolumeSource open_dicom_file(const std::filesystem::path& path);

}  // namespace pellicle
