#pragma once
/// What a segmentation with files at both ends gives: surfaces, maps, and where they came from.

#include <optional>
#include <string>
#include <vector>

#include "pellicle/image/files/volume_file.h"
#include "pellicle/job/segmentation.h"
#include "pellicle/output/run_record.h"
#include "pellicle/settings/settings.h"

namespace pellicle {

struct SegmentResult {
  SegmentSettings settings;  ///< with everything resolved that was left open
  VolumeHeader header;
  std::size_t nan_count = 0, inf_count = 0;
  float min = 0.0F, max = 0.0F;  ///< over the finite voxels
  Segmentation segmentation;
  std::optional<int> frame;  ///< of a time series, from 0
  std::vector<InputFile> inputs;
  std::vector<OutputFile> outputs;    ///< all but the report itself
  PhaseSeconds seconds;               ///< wall time of each phase, those of the segmentation among them
  std::vector<std::string> warnings;  ///< of the file, then of the segmentation

  bool writes_labels() const;  ///< a label map, not a mask
  /// 0, or 3 when an object failed its own checks.
  int exit_code() const;
};

}  // namespace pellicle
