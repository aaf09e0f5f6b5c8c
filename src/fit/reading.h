#pragma once
/// A reading: one way to understand the image around a seed. Polarity, levels, membrane or step, "alike the seed": all
/// are hypotheses of one kind, fitted alike and judged by the same evidence.

#include <optional>
#include <string>

#include "pellicle/energies/crossing.h"
#include "pellicle/energies/region.h"
#include "pellicle/fit/settings.h"
#include "pellicle/image/resample.h"

namespace pellicle {

/// The image is replaced by J = -min(|clip(I, level +- 2 range) smoothed - level|, range): bright where it is alike.
struct Similarity {
  double level = 0.0, range = 1.0;
};

struct Reading {
  std::string name;
  double sign = 1.0;  ///< of inside - outside
  bool ridge = false;
  double inside = 0.0, outside = 1.0;
  std::optional<Similarity> similarity;
  std::optional<TissueLevels> tissue;  ///< for the crossing energy
};

/// The part of the image that a stage works on: cropped around the surface, binned, read, smoothed. Rebuilt only when
/// the surface comes near its border.
class WorkingImage {
 public:
  WorkingImage(const Image<float>& image, const Reading& reading, double resolution, double smoothing_mm,
               double margin_mm);
  /// Makes sure that everything within the margin of `x` that lies in the volume is here.
  void cover(const std::vector<Vec3>& x);
  const Image<float>& image() const { return as_is_ ? source_ : image_; }
  double h() const { return h_; }  ///< of the working grid, mm

 private:
  const Image<float>& source_;
  const Reading& reading_;
  Index3 factor_;
  double smoothing_mm_, margin_mm_, h_;
  bool as_is_ = false;  ///< neither binned nor smoothed nor read anew: the input itself, no copy
  IndexBox box_;
  Image<float> image_;
};

}  // namespace pellicle
