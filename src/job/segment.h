#pragma once
/// The segmentation of a volume in memory: from an image and seeds to surfaces, figures and label map.

#include <memory>
#include <optional>
#include <vector>

#include "pellicle/base/observer.h"
#include "pellicle/job/object_seed.h"
#include "pellicle/job/segment_options.h"
#include "pellicle/job/segmentation.h"

namespace pellicle {

/// Fits a surface to each object, measures it and marks its voxels.
/// \param image finite values in any unit, on a grid of any orientation; move it in where it is not needed any more.
/// \param seeds one entry an object; none: one object is looked for, or all of many (SegmentOptions::many).
/// \return one result per object, those without a bad status and the others: the status is a part of the result.
/// \pre seeds have different labels (numbered()).
/// \throws UsageError for options that break a rule; BadData for an image without contrast, one in which no object
/// shows, and more than 65535 objects; Interrupted when the observer says so.
Segmentation segment(Image<float> image, const std::vector<ObjectSeed>& seeds, const SegmentOptions& options = {},
                     const Observer& observer = {});

/// The frames of a time series, one after the other: each starts where the last one ended.
class SegmentSeries {
 public:
  SegmentSeries();
  ~SegmentSeries();
  SegmentSeries(const SegmentSeries&) = delete;
  SegmentSeries& operator=(const SegmentSeries&) = delete;

  /// Where the next frame may start: the last believable surface of each object. None before the first frame, when an
  /// object has no such surface yet, and for many objects that are looked for anew in each frame.
  std::vector<ObjectSeed> carried_seeds() const;

  /// One frame, as `segment` does it. Many objects that are looked for (no seeds) get the labels of the objects that
  /// they overlap most in the last frame, and those of which no voxel lies in the image are dropped.
  /// \throws as segment.
  Segmentation next(Image<float> frame, const std::vector<ObjectSeed>& seeds, const SegmentOptions& options,
                    const Observer& observer = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pellicle
