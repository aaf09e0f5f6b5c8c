#pragma once
/// The parts of NIfTI reading that need libnifti's structures; for nifti_*.cpp only.

#include <nifti2_io.h>

#include <filesystem>
#include <string>

#include "pellicle/image/files/gz_file.h"
#include "pellicle/image/files/nifti_io.h"

namespace pellicle {

/// Any of the three headers in NIfTI-2 form and native byte order.
struct NiftiHeader {
  nifti_2_header fields{};
  int version = 0;  ///< 0 = Analyze 7.5
  bool single_file = false;
  bool swapped = false;
};

/// Reads and converts the header; nothing in it is checked but its kind. \throws BadData.
NiftiHeader read_nifti_header(GzFile& file, const std::filesystem::path& path);

NiftiFrame frame_of(const NiftiHeader& header);

/// Millimetres per unit of xyzt_units; 0 for a code that is no unit of length.
double mm_per_unit(int xyzt_units);
std::string unit_name(int xyzt_units);

/// Chooses the placement by the rules of nifti_io.h. \throws BadData.
ImageGrid grid_of(const NiftiFrame& frame, bool analyze, const Index3& size, const std::filesystem::path& path,
                  VolumeHeader& header);

}  // namespace pellicle
