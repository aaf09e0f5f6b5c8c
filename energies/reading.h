#pragma once
/// One way to read the image around a seed (a hypothesis): polarity, intensities, a step or a membrane, intensities
/// similar to the seed's; and the part of the image that a stage works on, read in that way.

#include <optional>
#include <string>
#include <vector>

#include "pellicle/image/resample.h"

namespace pellicle {

/// Levels (intensities) inside and outside, global and at each sample.
struct Levels {
  double inside = 0.0, outside = 0.0;
  std::vector<double> local_inside, local_outside;  ///< empty: the global ones hold everywhere
  double contrast() const { return inside - outside; }
};

/// Intensities that the threshold of the crossing energy is made of.
struct TissueLevels {
  double low = 0.0;        ///< robust minimum of the volume (2nd percentile)
  double threshold = 0.0;  ///< tissue against air: low + 0.1 (98th - 2nd percentile)
  double middle = 0.0;     ///< median of the tissue inside the surface
};

/// The image is replaced by J = -min(|clip(I, level +- 2 range) smoothed - level|, range): bright where it is similar
/// to the seed.
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
  double h() const { return h_; }           ///< of the working grid, mm
  int version() const { return version_; }  ///< another number, another image

 private:
  const Image<float>& source_;
  const Reading& reading_;
  Index3 factor_;
  double smoothing_mm_, margin_mm_, h_;
  bool as_is_ = false;  ///< neither binned nor smoothed nor read anew: the input itself, no copy
  int version_ = 0;
  IndexBox box_;
  Image<float> image_;
};

}  // namespace pellicle
