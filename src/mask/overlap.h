#pragma once
/// Overlap of two masks: Dice coefficient, intersection over union, volume error.

#include <cstdint>
#include <optional>

#include "pellicle/image/image.h"

namespace pellicle {

/// Rule for empty masks: both empty agree (dice and iou 1, volume error 0); one empty does not (dice and iou
/// 0), and against an empty truth a relative volume error does not exist.
struct OverlapMetrics {
  double dice = 0.0;                   ///< 2 |A and B| / (|A| + |B|)
  double iou = 0.0;                    ///< |A and B| / |A or B|
  std::optional<double> volume_error;  ///< (result - truth) / truth
  double truth_volume = 0.0;           ///< mm^3
  double result_volume = 0.0;          ///< mm^3
};

/// Voxels other than 0 are inside.
/// \throws BadData when the grids differ (same_grid).
OverlapMetrics overlap_of(const Image<std::uint8_t>& truth, const Image<std::uint8_t>& result);

}  // namespace pellicle
