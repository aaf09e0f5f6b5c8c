#pragma once
/// Cropping, binning and smoothing of images, and the noise in them.

#include "pellicle/image/image.h"

namespace pellicle {

/// Axis-aligned box of voxels.
struct IndexBox {
  Index3 begin{0, 0, 0}, size{0, 0, 0};
};

/// The smallest box of voxels that holds every point within `margin_mm` of the world box [lo, hi], cut at the image.
/// Never empty: at least the nearest voxel.
IndexBox box_around(const ImageGrid& grid, const Vec3& lo_in_world, const Vec3& hi_in_world, double margin_mm);

/// Bin factor of each axis with which voxels come nearest to `spacing_mm`, at least 1 (never up-sampled).
Index3 bin_factors(const ImageGrid& grid, double spacing_mm);

/// Mean over blocks of `factor` voxels within `box`; the last block of an axis may be smaller. World positions are
/// kept.
Image<float> crop_and_bin(const Image<float>& image, const IndexBox& box, const Index3& factor);

/// Separable Gaussian of `sigma_mm` (standard deviation in mm on every axis), cut at 3.5 sigma, border values
/// continued. An axis with sigma below 0.2 voxel is left alone. Deterministic for any number of threads.
Image<float> gaussian_smooth(Image<float> image, double sigma_mm);

/// Robust standard deviation of the noise: 1.4826 median |I - mean of the 6 neighbours| scaled by sqrt(6/7), over the
/// box's inner voxels (at most about 10^5 of them, evenly spread), zeros left out (air set to zero by the scanner).
double noise_of(const Image<float>& image, const IndexBox& box);

}  // namespace pellicle
