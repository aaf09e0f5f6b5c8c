#include "pellicle/energies/reading.h"

#include <algorithm>
#include <cmath>

namespace pellicle {

WorkingImage::WorkingImage(const Image<float>& image, const Reading& reading, double resolution, double smoothing_mm,
                           double margin_mm)
    : source_(image),
      reading_(reading),
      factor_(bin_factors(image.grid, resolution * image.grid.mean_spacing())),
      smoothing_mm_(smoothing_mm),
      margin_mm_(margin_mm) {
  as_is_ = factor_ == Index3{1, 1, 1} && smoothing_mm_ == 0.0 && !reading.similarity;
  h_ = image.grid.mean_spacing() *
       std::cbrt(static_cast<double>(factor_[0]) * static_cast<double>(factor_[1]) * static_cast<double>(factor_[2]));
}

void WorkingImage::cover(const std::vector<Vec3>& x) {
  if (as_is_) return;
  Vec3 lo = x.front(), hi = x.front();
  for (const Vec3& p : x) {
    lo = lo.cwiseMin(p);
    hi = hi.cwiseMax(p);
  }
  const IndexBox needed = box_around(source_.grid, lo, hi, margin_mm_);
  bool covered = !image_.voxels.empty();
  for (std::size_t a = 0; a < 3; ++a) {
    covered =
        covered && needed.begin[a] >= box_.begin[a] && needed.begin[a] + needed.size[a] <= box_.begin[a] + box_.size[a];
  }
  if (covered) return;
  // Half as much again, and on the same lattice of blocks whatever the box, so that voxels do not shift when it grows.
  box_ = box_around(source_.grid, lo, hi, 1.5 * margin_mm_ + 3.5 * smoothing_mm_);
  for (std::size_t a = 0; a < 3; ++a) {
    const int end = box_.begin[a] + box_.size[a];
    box_.begin[a] -= box_.begin[a] % factor_[a];
    box_.size[a] = std::min(source_.grid.size[a], (end + factor_[a] - 1) / factor_[a] * factor_[a]) - box_.begin[a];
  }
  ++version_;
  image_ = crop_and_bin(source_, box_, factor_);
  if (!reading_.similarity) {
    image_ = gaussian_smooth(std::move(image_), smoothing_mm_);
    return;
  }
  const auto level = static_cast<float>(reading_.similarity->level),
             range = static_cast<float>(reading_.similarity->range);
  for (float& v : image_.voxels) v = std::clamp(v, level - 2.0F * range, level + 2.0F * range);
  image_ = gaussian_smooth(std::move(image_), 0.7 * h_);
  for (float& v : image_.voxels) v = -std::min(std::abs(v - level), range);
  image_ = gaussian_smooth(std::move(image_), smoothing_mm_);
}

}  // namespace pellicle
