#pragma once
/// Surfaces that are linear in their control points (spline, Catmull-Clark, slime): every sample is a constant
/// combination of its patch's blocks.

#include <vector>

#include "pellicle/surface/parameters.h"
#include "pellicle/surface/samples.h"

namespace pellicle {

/// Weights of every sample over the blocks of its patch: x = sum w_b c_b, and two tangents likewise whose cross product
/// u x v points outward (their lengths mean nothing). Samples of a patch one after another, blocks.size() weights per
/// sample, from patch.jacobian_offset / 9 on.
struct LinearStencils {
  std::vector<double> x, u, v;
};

/// Appends a patch whose samples follow; sets jacobian_offset. The patch's stencils are appended by add_sample.
void begin_patch(SampleLayout& layout, std::vector<int> blocks);
/// Appends a sample of the last patch with its weights over that patch's blocks; returns its number.
/// \pre x, u and v have one weight per block.
int add_sample(SampleLayout& layout, LinearStencils& stencils, const std::vector<double>& x,
               const std::vector<double>& u, const std::vector<double>& v);

/// Positions, unit normals and, when asked, Jacobians. Threads over patches, deterministic.
/// \throws BadData when sizes do not match.
void evaluate_linear(const Parameters& parameters, const SampleLayout& layout, bool with_jacobian,
                     SurfaceSamples& samples);
/// Adds sum_i (dx_i/dparameters)^T dE_dx_i to `gradient`.
void pull_back_linear(const SampleLayout& layout, const std::vector<Vec3>& dE_dx, std::vector<double>& gradient);

}  // namespace pellicle
