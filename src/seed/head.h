#pragma once
/// Robust statistics of a T1 head (Smith 2002, Human Brain Mapping 17:143-155).

#include "pellicle/energies/reading.h"
#include "pellicle/seed/seed.h"

namespace pellicle {

struct HeadReading {
  TissueLevels levels;       ///< `middle`: median of the tissue within the head's ball
  Vec3 center{0, 0, 0};      ///< centre of gravity of what is brighter than the threshold, LPS mm
  double head_radius = 0.0;  ///< of a ball with the volume of what is brighter than the threshold, mm
};

/// \throws BadData for an image without contrast.
HeadReading read_head(const Image<float>& image);

}  // namespace pellicle
