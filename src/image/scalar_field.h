#pragma once
/// An image as a function of world position.

#include "pellicle/image/image.h"

namespace pellicle {

/// Continuous (trilinear) values along straight lines: for intensity profiles. Holds a reference to the image.
class TrilinearField {
 public:
  explicit TrilinearField(const Image<float>& image);
  /// out[i] = I(start + i step), i = 0..count-1, world mm. Up to half a voxel beyond the outermost centres the border
  /// value is continued; further out the value is NaN.
  void along_line(const Vec3& start_in_world, const Vec3& step_in_world, int count, float* out) const;
  float at(const Vec3& x_in_world) const;

 private:
  float at_index(const Vec3& i) const;
  const Image<float>& image_;
  Mat3 index_from_world_;
};

/// Continuously differentiable values: tricubic Catmull-Rom (Keys 1981, a = -1/2), interpolating, 64 voxels per point,
/// border values continued. For the scalar energies, whose gradient must be the derivative of the value.
class CubicField {
 public:
  explicit CubicField(const Image<float>& image);
  double value(const Vec3& x_in_world) const;
  /// Value; `gradient` in intensity per mm along the world axes.
  double value(const Vec3& x_in_world, Vec3& gradient) const;

 private:
  const Image<float>& image_;
  Mat3 index_from_world_;
};

}  // namespace pellicle
