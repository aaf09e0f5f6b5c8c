#pragma once
/// Where the index axes of a grid point to in the patient.

#include <string>

#include "pellicle/image/image_grid.h"

namespace pellicle {

/// The nearest anatomical direction of each index axis: "RAS" for +i right, +j anterior, +k superior.
std::string orientation_code(const ImageGrid& grid);

}  // namespace pellicle
