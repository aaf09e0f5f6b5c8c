#pragma once
/// Reading volumes of every supported format into LPS mm, and writing masks and maps on the very same grid.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pellicle/image/image.h"

namespace pellicle {

/// The parts of a NIfTI header that say where the voxels are, kept bit for bit so that a mask carries them unchanged.
struct NiftiFrame;

/// What a file says of itself.
struct VolumeHeader {
  std::string format;          ///< "NIfTI-1", "NIfTI-2", "NRRD", "MetaImage", "TIFF", "DICOM series", ...
  std::string component_type;  ///< as stored: "uint8", "int16", ..., "float64"
  ImageGrid grid;
  std::string unit;                  ///< of length as stored: "mm", "um", "m", "unknown"; the grid is always mm
  bool spacing_known = true;         ///< false: the file has none and none was given, 1 mm was assumed (with a warning)
  int frames = 1;                    ///< volumes in the file, along the fourth axis; more than 1 only with a frame
  double frame_step = 0.0;           ///< between them, in frame_unit
  std::string frame_unit = "frame";  ///< "s", or "frame" when the file does not say
  double slope = 1.0, intercept = 0.0;      ///< already applied to the voxels
  std::vector<std::string> warnings;        ///< one sentence each, for the user
  std::shared_ptr<const NiftiFrame> nifti;  ///< null unless the file was NIfTI
};

/// A grey-scale volume. Voxels that were NaN or infinite are counted, then replaced by the smallest finite value.
struct Volume {
  VolumeHeader header;
  Image<float> image;
  std::size_t nan_count = 0, inf_count = 0;
  float min = 0.0F, max = 0.0F;  ///< over the finite voxels
};

struct ReadOptions {
  std::optional<Vec3> spacing = {};  ///< overrides the file's, mm (`spacing`)
  std::optional<int> frame = {};     ///< of a 4D file, from 0; without it a 4D file is refused
};

/// Reads a file, or a folder that holds one DICOM series.
/// \throws NoInput: no such file or folder.  BadData: unreadable, truncated, not 3D (or no time series, or without such
/// a frame), RGB, complex, sheared, singular
///         or absurd header, uneven slices, mixed series, no finite voxel. The message is one line that says which.
Volume read_volume(const std::filesystem::path& path, const ReadOptions& options = {});

/// Header only where the format allows it. Same errors as read_volume, except those about voxel values.
VolumeHeader read_header(const std::filesystem::path& path, const ReadOptions& options = {});

/// Volumes along the fourth axis of a NIfTI file; 1 for every other file and for none. \throws as read_header.
int frame_count(const std::filesystem::path& path);

/// A label map or mask; values must be whole numbers. \throws as read_volume; BadData for fractions.
struct LabelVolume {
  VolumeHeader header;
  Image<std::int32_t> labels;
};
LabelVolume read_labels(const std::filesystem::path& path, const ReadOptions& options = {});

/// Writes NIfTI (.nii or .nii.gz by name) atomically on the grid of `like`; when `like` came from NIfTI its
/// qform, sform, their codes, pixdim and units are copied bit for bit. Works for uint8, uint16, int16, int32, float.
/// \pre image.grid.size equals like.grid.size.  \throws CannotCreate, IoError.
template <class T>
void write_volume(const std::filesystem::path& path, const Image<T>& image, const VolumeHeader& like);

extern template void write_volume(const std::filesystem::path&, const Image<std::uint8_t>&, const VolumeHeader&);
extern template void write_volume(const std::filesystem::path&, const Image<std::uint16_t>&, const VolumeHeader&);
extern template void write_volume(const std::filesystem::path&, const Image<std::int16_t>&, const VolumeHeader&);
extern template void write_volume(const std::filesystem::path&, const Image<std::int32_t>&, const VolumeHeader&);
extern template void write_volume(const std::filesystem::path&, const Image<float>&, const VolumeHeader&);

}  // namespace pellicle
