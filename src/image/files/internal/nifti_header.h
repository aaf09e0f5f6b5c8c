#pragma once
/// A NIfTI or Analyze header in libnifti's structures.

#include <nifti2_io.h>

#include <filesystem>

#include "pellicle/image/files/internal/gz_file.h"
#include "pellicle/image/files/internal/nifti_frame.h"

namespace pellicle {

/// Any of the three headers in NIfTI-2 form and native byte order.
struct NiftiHeader {
  nifti_2_header fields{};
  int version = 0;  ///< 0 = Analyze 7.5
  bool single_file = false;
  bool swapped = false;
};

/// Reads and converts the header; nothing in it is checked but its kind.
/// \throws BadData.
NiftiHeader read_nifti_header(GzFile& file, const std::filesystem::path& path);

/// Where the header says that the voxels are.
NiftiFrame frame_of(const NiftiHeader& header);

}  // namespace pellicle
