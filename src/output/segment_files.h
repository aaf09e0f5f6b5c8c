#pragma once
/// The main job with files at both ends: a volume and its settings to masks, meshes, models, pictures and a report.

#include <optional>
#include <string>
#include <vector>

#include "pellicle/base/observer.h"
#include "pellicle/image/files/volume_file.h"
#include "pellicle/job/segment.h"
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

/// Reads, seeds, segments and writes. Nothing is written before every object is fitted and measured.
/// \throws what settings.validate(), read_volume, read_seeds, job/segment.h and the writers throw; CannotCreate when an
/// output exists and settings.overwrite is false (before any work); Interrupted when the observer says so.
SegmentResult segment_to_files(const SegmentSettings& settings, const RunRecord& record, const Observer& observer);

/// The same for one frame of a 4D volume, which starts where the last one of the series ended.
/// \throws as segment_to_files.
SegmentResult segment_frame_to_files(const SegmentSettings& settings, int frame, SegmentSeries& series,
                                     const RunRecord& record, const Observer& observer);

/// What can be refused before any image is read: missing files, outputs that exist.
/// \throws as segment_to_files.
void check_before_work(const SegmentSettings& settings);

/// The choices of a segmentation, without its files.
/// \param grid of the maps: that of the input file.
SegmentOptions options_of(const SegmentSettings& settings, const ImageGrid& grid);

}  // namespace pellicle
