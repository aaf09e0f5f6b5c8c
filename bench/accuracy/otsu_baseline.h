#pragma once
/// What a threshold reaches without any model: the figure printed beside each fit.

#include <cstdint>

#include "pellicle/image/image.h"

namespace pellicle::bench {

/// Between the two classes of largest between-class variance, on 512 bins over the image's range (Otsu 1979).
/// The mean of the optimal bins where several are equal. \pre the image is not empty.
double otsu_threshold(const Image<float>& image);

enum class OtsuObject {
  solid,  ///< the class of most of the 27 voxels around the seed: dark objects work as well as bright ones
  shell   ///< the smaller of the two classes is the membrane; the holes it encloses are filled
};

/// One 6-connected component of the object's class. Solid: the one that holds most of those 27 voxels (under a bias
/// field the largest of the class may be a corner of the background). Shell: the largest.
/// \param seed_in_world LPS mm, inside the volume.  \throws BadData when it lies outside.
Image<std::uint8_t> otsu_baseline(const Image<float>& image, const Vec3& seed_in_world, OtsuObject object);

}  // namespace pellicle::bench
