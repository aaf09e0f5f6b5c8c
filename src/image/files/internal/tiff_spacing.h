#pragma once
/// The voxel size that a TIFF's description carries: OME-XML or ImageJ's lines.

#include <optional>
#include <string>
#include <vector>

#include "pellicle/base/geometry.h"

namespace pellicle {

struct TiffDescription {
  std::string text;                                  ///< ImageDescription of the first page
  std::optional<double> x_resolution, y_resolution;  ///< pixels per unit
  int pages = 0;
};

struct TiffSpacing {
  Vec3 spacing{1, 1, 1};                     ///< mm
  bool known = false;                        ///< true: all three, with a unit
  std::string unit = "unknown", source;      ///< source: "OME", "ImageJ" or empty
  int channels = 1, frames = 1, slices = 0;  ///< slices 0: not said
  std::vector<std::string> warnings;         ///< begin with "NO SPACING" whenever known is false
};

/// OME: PhysicalSizeX/Y/Z with their units (default um, as the OME schema has it). ImageJ: `spacing=` (z) and pixels
/// per `unit` in the resolution tags; ImageJ leaves `spacing=` out when it is 1 unit or was never set, so that this
/// counts as unknown. Resolution tags alone are a printer's dots per inch and ignored.
TiffSpacing tiff_spacing(const TiffDescription& description);

}  // namespace pellicle
