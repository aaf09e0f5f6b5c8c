#pragma once
/// Labels that objects keep from frame to frame.

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "pellicle/image/image.h"

namespace pellicle {

/// Gives each object of a frame the label of one in the frame before, or a new one.
/// First by overlap: pairs in the order of their intersection over union, each object once, down to a tenth. Then, for
/// those that moved out of their own shadow, by centre: pairs in the order of distance, down to the sum of both radii.
class LabelTracks {
 public:
  /// What is known of a labelled object in a frame.
  struct Track {
    Vec3 centre{0, 0, 0};  ///< LPS mm
    double radius = 0.0;   ///< of the ball of equal volume, mm
    double voxels = 0.0;
  };

  /// \param labels of the new frame, on the same grid in every call.
  /// \return from the label in `labels` to the one that it keeps; the caller's image is relabelled.
  std::map<int, int> follow(Image<std::uint16_t>& labels);

 private:
  Image<std::uint16_t> before_;
  std::map<int, Track> tracks_;  ///< of the last frame in which each was seen: also of those lost for a while
  int next_ = 1;
};

}  // namespace pellicle
