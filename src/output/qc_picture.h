#pragma once
/// The picture of a segmentation's result: slices with the contour, and a shaded view.

#include <string>
#include <vector>

#include "pellicle/image/image.h"
#include "pellicle/job/segmentation.h"
#include "pellicle/picture/canvas.h"

namespace pellicle {

/// A row for each object with its volume and status (picture/slice_rows.h).
/// \param name stem of the run, the beginning of each title.
Canvas qc_picture(const Image<float>& image, const std::vector<ObjectResult>& objects, const std::string& name);

/// Many objects in one row: slices through the middle of the stack with every contour and its label, and how many there
/// are.
/// \pre each object has a shape.
Canvas overview_picture(const Image<float>& image, const std::vector<ObjectResult>& objects, const std::string& name);

}  // namespace pellicle
