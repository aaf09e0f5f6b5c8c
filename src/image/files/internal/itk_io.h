#pragma once
/// NRRD (.nrrd, .nhdr) and MetaImage (.mha, .mhd), decoded by ITK's reader objects for these two formats.
///
/// ITK gives LPS whatever the file's `space` is. What it does not pass on is looked up in the text header: whether an
/// NRRD names a space at all (a warning if not), its unit of length, and the size of the data, so that an absurd claim
/// is refused before memory is allocated.

#include <filesystem>

#include "pellicle/image/files/internal/voxel_source.h"

namespace pellicle {

/// \throws BadData, as read_volume.
VolumeSource open_itk_file(const std::filesystem::path& path);

}  // namespace pellicle
