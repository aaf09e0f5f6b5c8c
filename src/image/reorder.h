#pragma once
/// One storage order for all volumes, so that results do not depend on the order in which a file stores its voxels.

#include <cstdint>

#include "pellicle/image/image.h"

namespace pellicle {

/// The same voxels at the same places in the world, stored so that the index axes run as nearly as possible along +x,
/// +y and +z of LPS (axes swapped and reversed, nothing interpolated). Volumes that differ only in storage order come
/// out with the same voxels in the same order. Works in place where no axes are swapped.
template <class T>
Image<T> in_lps_order(Image<T> image);

extern template Image<float> in_lps_order(Image<float>);
extern template Image<std::uint8_t> in_lps_order(Image<std::uint8_t>);

}  // namespace pellicle
