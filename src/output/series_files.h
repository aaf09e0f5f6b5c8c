#pragma once
/// A time series with files at both ends: the frames of a 4D volume one after the other.

#include <string>
#include <vector>

#include "pellicle/output/segment_files.h"

namespace pellicle {

/// One object in one frame.
struct SeriesRow {
  int frame = 0;      ///< from 0
  double time = 0.0;  ///< seconds, or the frame's number where the file knows no time
  int label = 1;      ///< the same for one object in all frames
  std::string name;
  double volume_ml = 0.0;  ///< of the surface
  FitStatus status = FitStatus::ok;
  std::string reason;
  double seconds = 0.0;
};

struct SeriesResult {
  std::vector<SeriesRow> rows;  ///< by frame
  int exit_code = 0;            ///< 3 when an object of some frame failed its checks
};

/// Frames of the input; 1 for all that is not a 4D NIfTI file.
/// \throws as read_header.
int frames_of(const SegmentSettings& settings);

/// Every frame t as `segment_to_files` does it, under the name STEM_tNNN; besides STEM_series.tsv and STEM_series.png.
/// One object, or several with seeds: each starts from its last believable surface. Many objects that are looked for:
/// found anew in each frame, then given the labels of the objects that they overlap most in the last frame.
/// \throws as segment_to_files; UsageError with expert points.
SeriesResult segment_series_to_files(const SegmentSettings& settings, const RunRecord& record,
                                     const Observer& observer);

}  // namespace pellicle
