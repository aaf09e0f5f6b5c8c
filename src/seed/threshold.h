#pragma once
/// A threshold from the values alone.

#include <vector>

namespace pellicle {

/// The threshold that parts the values into two classes of least variance (Otsu 1979), on 256 bins between the 0.5th
/// and the 99.5th percentile.
/// \pre there are values.
double threshold_of_two_classes(std::vector<float> values);

}  // namespace pellicle
