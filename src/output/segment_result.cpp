#include "pellicle/output/segment_result.h"

namespace pellicle {

bool SegmentResult::writes_labels() const {
  return segmentation.objects.size() > 1 || settings.wants_many();
}

int SegmentResult::exit_code() const {
  return segmentation.all_ok() ? 0 : 3;
}

}  // namespace pellicle
