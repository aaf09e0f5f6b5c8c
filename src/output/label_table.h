#pragma once
/// The table beside a label map: a line an object.

#include <string>
#include <vector>

#include "pellicle/job/segmentation.h"

namespace pellicle {

/// Tab-separated: index, name, volume_ml, status; of many objects more, as docs/nuclei.md lists them.
std::string label_table(const std::vector<ObjectResult>& objects);

}  // namespace pellicle
