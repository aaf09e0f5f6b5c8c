#pragma once
/// The fits of a segmentation: one object after the other, or many of one kind together.

#include <vector>

#include "pellicle/base/observer.h"
#include "pellicle/job/object_seed.h"
#include "pellicle/job/segment_options.h"
#include "pellicle/job/segmentation.h"

namespace pellicle {

/// One fit for each seed; fills result.objects.
/// \param image in LPS order.
/// \throws Interrupted.
void fit_objects(const Image<float>& image, const std::vector<ObjectSeed>& seeds, const SegmentOptions& options,
                 const Observer& observer, Segmentation& result);

/// Finds the objects or, with seeds, fits one to each; fills result.objects and result.many.
/// \param image in LPS order. It is changed: move it in.
/// \throws BadData for more objects than a label map holds; Interrupted.
void fit_many_objects(Image<float> image, const std::vector<ObjectSeed>& seeds, const SegmentOptions& options,
                      const Observer& observer, Segmentation& result);

}  // namespace pellicle
