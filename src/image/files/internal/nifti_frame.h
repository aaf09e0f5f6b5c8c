#pragma once
/// Where a NIfTI header says that the voxels are, as stored, and the grid that it means.

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

#include "pellicle/image/volume.h"

namespace pellicle {

/// As stored, RAS, in the file's own unit. float32 of NIfTI-1 fit into double unchanged.
struct NiftiFrame {
  int version = 1;
  std::int32_t qform_code = 0, sform_code = 0, xyzt_units = 0;
  std::array<double, 4> pixdim{1, 1, 1, 1};  ///< [0] is qfac
  std::array<double, 3> quatern{0, 0, 0}, qoffset{0, 0, 0};
  std::array<std::array<double, 4>, 3> srow{};
};

/// Millimetres per unit of xyzt_units; 0 for a code that is not a unit of length.
double mm_per_unit(int xyzt_units);
std::string unit_name(int xyzt_units);

/// Chooses the placement by the rules of nifti_io.h.
/// \throws BadData.
ImageGrid grid_of(const NiftiFrame& frame, bool analyze, const Index3& size, const std::filesystem::path& path,
                  VolumeHeader& header);

}  // namespace pellicle
