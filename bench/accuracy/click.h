#pragma once
/// One click of a user who knows where the object is: the only thing that these sections take from the truth.

#include "pellicle/image/image.h"
#include "pellicle/mask/overlap.h"
#include "pellicle/seed/seed.h"
#include "pellicle/surface/surface.h"

namespace pellicle::bench {

/// 1 where the labels are one of `wanted`; any label above 0 when there are none. In LPS order (image/reorder.h), as
/// the program sees images: voxels that are stored in another order are summed in another, and fits from bad seeds
/// differ.
Image<std::uint8_t> mask_of_labels(const Image<std::int32_t>& labels, const std::vector<int>& wanted = {});

/// The voxel centre of the object that lies deepest, LPS mm. \pre the mask is not empty.
Vec3 deepest_point(const Image<std::uint8_t>& truth);

/// Of a fitted surface and of a truth on `truth`'s grid.
OverlapMetrics overlap_with(const Image<std::uint8_t>& truth, const Surface& surface);

/// Dice of the best of all windows lo <= I <= hi within the truth dilated by 5 mm: what no threshold can surpass, as
/// the window and the place are taken from the truth.
double best_window_dice(const Image<float>& image, const Image<std::uint8_t>& truth);

}  // namespace pellicle::bench
