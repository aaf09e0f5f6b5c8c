#include "pellicle/surface/linear_stencils.h"

#include <fmt/format.h>

#include "pellicle/base/errors.h"
#include "pellicle/base/parallel.h"

namespace pellicle {
namespace {

constexpr std::size_t kGrain = 16;  ///< patches a task

void require(bool condition, const char* what) {
  if (!condition) throw BadData(fmt::format("{} (surface model): does not match the samples' layout", what));
}

Vec3 combine(const std::vector<double>& weights, std::size_t first, const std::vector<int>& blocks,
             const Parameters& parameters) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    sum += weights[first + b] * Vec3(parameters.data() + 3 * static_cast<std::size_t>(blocks[b]));
  }
  return sum;
}

}  // namespace

void begin_patch(SampleLayout& layout, std::vector<int> blocks) {
  SamplePatch patch;
  patch.first_sample = layout.sample_count();
  if (!layout.patches.empty()) {
    const SamplePatch& last = layout.patches.back();
    patch.jacobian_offset = last.jacobian_offset + 3 * static_cast<std::size_t>(last.sample_count) * last.columns();
  }
  patch.blocks = std::move(blocks);
  layout.patches.push_back(std::move(patch));
}

int add_sample(SampleLayout& layout, LinearStencils& stencils, const std::vector<double>& x,
               const std::vector<double>& u, const std::vector<double>& v) {
  const int sample = layout.sample_count();
  stencils.x.insert(stencils.x.end(), x.begin(), x.end());
  stencils.u.insert(stencils.u.end(), u.begin(), u.end());
  stencils.v.insert(stencils.v.end(), v.begin(), v.end());
  layout.patch_of.push_back(static_cast<int>(layout.patches.size()) - 1);
  ++layout.patches.back().sample_count;
  return sample;
}

void evaluate_linear(const Parameters& parameters, const SampleLayout& layout, bool with_jacobian,
                     SurfaceSamples& samples) {
  require(layout.stencils != nullptr, "sample layout");
  const LinearStencils& stencils = *layout.stencils;
  std::size_t weights = 0;
  for (const SamplePatch& patch : layout.patches) {
    weights += static_cast<std::size_t>(patch.sample_count) * patch.blocks.size();
    for (const int b : patch.blocks) {
      require(b >= 0 && 3 * static_cast<std::size_t>(b) + 3 <= parameters.size(), "parameters");
    }
  }
  require(stencils.x.size() == weights && stencils.u.size() == weights && stencils.v.size() == weights, "stencils");
  samples.x.resize(layout.patch_of.size());
  samples.normal.resize(layout.patch_of.size());
  samples.jacobian.assign(with_jacobian ? 9 * weights : 0, 0.0);
  parallel_for(layout.patches.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      const SamplePatch& patch = layout.patches[p];
      const std::size_t count = patch.blocks.size();
      std::size_t at = patch.jacobian_offset / 9;
      for (int k = 0; k < patch.sample_count; ++k, at += count) {
        const auto sample = static_cast<std::size_t>(patch.first_sample + k);
        samples.x[sample] = combine(stencils.x, at, patch.blocks, parameters);
        samples.normal[sample] = combine(stencils.u, at, patch.blocks, parameters)
                                     .cross(combine(stencils.v, at, patch.blocks, parameters))
                                     .normalized();
        if (!with_jacobian) continue;
        double* const rows = samples.jacobian.data() + 9 * at;
        for (std::size_t b = 0; b < count; ++b) {
          for (std::size_t axis = 0; axis < 3; ++axis) rows[axis * 3 * count + 3 * b + axis] = stencils.x[at + b];
        }
      }
    }
  });
}

void pull_back_linear(const SampleLayout& layout, const std::vector<Vec3>& dE_dx, std::vector<double>& gradient) {
  require(layout.stencils != nullptr, "sample layout");
  require(dE_dx.size() == layout.patch_of.size(), "dE/dx");
  for (const SamplePatch& patch : layout.patches) {  // in one order whatever the number of threads
    std::size_t at = patch.jacobian_offset / 9;
    for (int k = 0; k < patch.sample_count; ++k) {
      const Vec3& bar = dE_dx[static_cast<std::size_t>(patch.first_sample + k)];
      for (const int b : patch.blocks) {
        const double w = layout.stencils->x[at++];
        double* const g = gradient.data() + 3 * static_cast<std::size_t>(b);
        for (int axis = 0; axis < 3; ++axis) g[axis] += w * bar[axis];
      }
    }
  }
}

}  // namespace pellicle
