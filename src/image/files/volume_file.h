#pragma once
/// Reading volumes of every supported format into LPS mm, and writing masks and maps on the very same grid.

#include <cstdint>
#include <filesystem>
#include <optional>

#include "pellicle/image/volume.h"

namespace pellicle {

struct ReadOptions {
  std::optional<Vec3> spacing = {};  ///< overrides the file's, mm (`spacing`)
  std::optional<int> frame = {};     ///< of a 4D file, from 0; without it a 4D file is refused
};

/// Reads a file, or a folder that holds one DICOM series.
/// \throws NoInput: no such file or folder.
/// \throws BadData: unreadable, truncated, not 3D (or not a time series, or one without such a frame), RGB, complex,
///         sheared, singular or absurd header, uneven slices, mixed series, not one finite voxel. The message is one
///         line that says which.
Volume read_volume(const std::filesystem::path& path, const ReadOptions& options = {});

/// Header only where the format allows it.
/// \throws as read_volume, except for what is wrong with voxel values.
VolumeHeader read_header(const std::filesystem::path& path, const ReadOptions& options = {});

/// Volumes along the fourth axis of a NIfTI file; 1 for every other file, and where there is none.
/// \throws as read_header.
int frame_count(const std::filesystem::path& path);

/// A label map or mask; values must be whole numbers.
/// \throws as read_volume; BadData for fractions.
LabelVolume read_labels(const std::filesystem::path& path, const ReadOptions& options = {});

/// Writes NIfTI (.nii or .nii.gz by name) atomically on the grid of `like`; when `like` came from NIfTI its
/// qform, sform, their codes, pixdim and units are copied bit for bit. Works for uint8, uint16, int16, int32, float.
/// \pre image.grid.size equals like.grid.size.
/// \throws CannotCreate, IoError.
template <class T>
void write_volume(const std::filesystem::path& path, const Image<T>& image, const VolumeHeader& like);

extern template void write_volume(const std::filesystem::path&, const Image<std::uint8_t>&, const VolumeHeader&);
extern template void write_volume(const std::filesystem::path&, const Image<std::uint16_t>&, const VolumeHeader&);
extern template void write_volume(const std::filesystem::path&, const Image<std::int16_t>&, const VolumeHeader&);
extern template void write_volume(const std::filesystem::path&, const Image<std::int32_t>&, const VolumeHeader&);
extern template void write_volume(const std::filesystem::path&, const Image<float>&, const VolumeHeader&);

}  // namespace pellicle
