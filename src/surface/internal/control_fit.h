#pragma once
/// Least-squares control points of the models that are linear in them.

#include <memory>
#include <vector>

#include "pellicle/base/geometry.h"
#include "pellicle/surface/parameters.h"
#include "pellicle/surface/samples.h"

namespace pellicle {

/// Brings samples to given places: min sum_i |x_i - target_i|^2. Keeps the factorised normal equations.
class ControlFit {
 public:
  /// \pre `layout` has stencils over blocks 0 .. block_count - 1.
  /// \throws BadData when it has none.
  ControlFit(const SampleLayout& layout, int block_count);
  ~ControlFit();
  ControlFit(const ControlFit&) = delete;
  ControlFit& operator=(const ControlFit&) = delete;
  /// \param target one per sample. What the samples do not determine stays as in `prior`.
  Parameters solve(const std::vector<Vec3>& target, const Parameters& prior) const;

 private:
  struct Factor;
  SampleLayout layout_;
  std::unique_ptr<Factor> factor_;
};

/// Control points whose surface is nearest to the unit sphere about the origin, from near ones.
Parameters fit_unit_sphere(const SampleLayout& layout, const Parameters& start);

}  // namespace pellicle
