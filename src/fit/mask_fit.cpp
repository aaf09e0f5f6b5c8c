#include <algorithm>
#include <optional>

#include "pellicle/base/errors.h"
#include "pellicle/fit/fit.h"
#include "pellicle/fit/point_fit.h"
#include "pellicle/fit/stage.h"
#include "pellicle/image/reorder.h"
#include "pellicle/image/resample.h"
#include "pellicle/mesh/overlap.h"
#include "pellicle/raster/rasterize.h"
#include "pellicle/seed/components.h"
#include "pellicle/seed/seed_surface.h"
#include "pellicle/seed/voxel_seed.h"

namespace pellicle {
namespace {

/// The largest part of a mask, alone, and as an image: its box with room around it, so that what the volume cuts off
/// ends there instead of going on for ever.
struct Part {
  Image<std::uint8_t> mask;
  Image<float> image;
};

/// The box of the voxels with `label`, and a tenth of its length and four voxels more on every side.
IndexBox box_of(const Image<std::int32_t>& labels, std::int32_t label) {
  Index3 first = labels.grid.size, last{-1, -1, -1};
  for (int k = 0; k < labels.grid.size[2]; ++k) {
    for (int j = 0; j < labels.grid.size[1]; ++j) {
      for (int i = 0; i < labels.grid.size[0]; ++i) {
        if (labels.at(i, j, k) != label) continue;
        const Index3 here{i, j, k};
        for (std::size_t a = 0; a < 3; ++a) {
          first[a] = std::min(first[a], here[a]);
          last[a] = std::max(last[a], here[a]);
        }
      }
    }
  }
  IndexBox box;
  for (std::size_t a = 0; a < 3; ++a) {
    const int length = last[a] - first[a] + 1, room = 4 + length / 10;
    box.begin[a] = first[a] - room;
    box.size[a] = length + 2 * room;
  }
  return box;
}

Part largest_part(const Image<std::uint8_t>& mask) {
  const Image<std::uint8_t> ordered = in_lps_order(mask);
  const Components components = components_of(ordered);
  if (components.parts.empty()) throw BadData("the seed mask is empty");
  const int largest = components.parts.front().id;
  const IndexBox box = box_of(components.labels, largest);
  ImageGrid grid = ordered.grid;
  grid.size = box.size;
  grid.origin_in_world = ordered.grid.world_from_index({1.0 * box.begin[0], 1.0 * box.begin[1], 1.0 * box.begin[2]});
  Part part{Image<std::uint8_t>(grid), Image<float>(grid)};
  const auto inside = [&](const Index3& at) {
    for (std::size_t a = 0; a < 3; ++a) {
      if (at[a] < 0 || at[a] >= ordered.grid.size[a]) return false;
    }
    return components.labels.at(at[0], at[1], at[2]) == largest;
  };
  std::size_t voxel = 0;
  for (int k = 0; k < box.size[2]; ++k) {
    for (int j = 0; j < box.size[1]; ++j) {
      for (int i = 0; i < box.size[0]; ++i, ++voxel) {
        if (inside({box.begin[0] + i, box.begin[1] + j, box.begin[2] + k})) {
          part.mask.voxels[voxel] = 1;
          part.image.voxels[voxel] = 1.0F;
        }
      }
    }
  }
  return part;
}

FitState state_of(Surface surface, int detail) {
  return {.surface = std::move(surface),
          .detail = detail,
          .reading = {.name = "mask", .sign = 1.0, .inside = 1.0, .outside = 0.0, .similarity = {}, .tissue = {}},
          .levels = {1.0, 0.0, {}, {}},
          .reason = {}};
}

/// To the boundary of the part, stage by stage: (detail, how far to look in mm). Ends before a stage that fails.
struct MaskFit {
  Surface surface;
  bool complete = true;
};

MaskFit fitted(const Image<float>& image, FitState state, const std::vector<std::pair<int, double>>& stages) {
  FitSettings settings;
  GeometryCache geometry;
  const StageContext context{image, settings, geometry};
  for (const auto& [detail, reach] : stages) {
    state.reach_mm = reach;
    const Stage stage{.name = "mask",
                      .detail = detail,
                      .energies = {{"region", 1.0}, {"bending", 5e-6}, {"spacing", 0.3}},
                      .resolution = 0.0,
                      .smoothing = 0.7,
                      .reach = 5.0,
                      .max_steps = 15};
    const FitState before = state;
    run_stage(context, stage, state);
    if (state.status != FitStatus::ok) return {before.surface, false};
  }
  return {state.surface};
}

/// Whether the surface is the mask but for details.
bool covers(const Surface& surface, const Image<std::uint8_t>& mask) {
  constexpr double kDice = 0.9;
  const int level = tessellation_level(surface, 0.7 * mask.grid.mean_spacing());
  return overlap_of(mask, rasterize_mask(tessellate(surface, level), mask.grid)).dice >= kDice;
}

/// From the voxels' own boundary, drawn to that of the mask and refined where these are too coarse for it: for any
/// shape and genus, any number of control points.
std::optional<Surface> from_voxels(const Part& part, const VoxelSeed& voxels, const ModelChoice& choice) {
  constexpr int kSamples = 4000;
  const std::optional<Surface> start = seed_surface(voxels.mesh, choice);
  if (!start) return std::nullopt;
  const GeometryData data = data_of(surface_of_mask(part.mask), kSamples);
  const PointFitSettings settings{.max_steps = 4};
  const Surface coarse = fit_from(*start, data, settings, false).surface;
  return covers(coarse, part.mask) ? coarse : fit_from(refine(coarse), data, settings, false).surface;
}

}  // namespace

Surface surface_from_mask(const Image<std::uint8_t>& mask, const ModelChoice& choice, int detail) {
  const Part part = largest_part(mask);
  const VoxelSeed voxels = voxel_seed_of_mask(part.mask);
  if (voxels.genus > 0) {
    if (const std::optional<Surface> start = from_voxels(part, voxels, choice)) return *start;
  }
  const Moments moments = moments_of(part.mask);
  const SurfaceModel model = start_model(choice);
  const double radius = std::cbrt(std::abs(moments.shape.determinant()));
  std::vector<std::pair<int, double>> stages;
  for (int d = std::min(1, detail); d <= detail; ++d) stages.emplace_back(d, d <= 1 ? 0.6 * radius : 0.2 * radius);
  const Surface ellipsoid{model, on_ellipsoid(model, moments.centroid, moments.shape)};
  MaskFit fit = fitted(part.image, state_of(ellipsoid, 0), stages);
  if (fit.complete) return fit.surface;
  // Long and bent: the ellipsoid lies across it.
  return from_voxels(part, voxels, choice).value_or(std::move(fit.surface));
}

}  // namespace pellicle
