#pragma once
/// A grey-scale volume or a label map with what its file says of itself.

#include <cstdint>
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

/// A label map or mask: whole numbers.
struct LabelVolume {
  VolumeHeader header;
  Image<std::int32_t> labels;
};

}  // namespace pellicle
