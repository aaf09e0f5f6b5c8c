#include <algorithm>
#include <optional>

#include "pellicle/energies/energy_kinds.h"
#include "pellicle/fit/fit.h"
#include "pellicle/fit/geometry/point_fit.h"
#include "pellicle/fit/stage.h"
#include "pellicle/image/reorder.h"
#include "pellicle/mask/moments.h"
#include "pellicle/mask/overlap.h"
#include "pellicle/mask/parts.h"
#include "pellicle/raster/rasterize.h"
#include "pellicle/seed/seed_surface.h"
#include "pellicle/seed/voxel_seed.h"

namespace pellicle {
namespace {

/// The largest part of a mask, alone, and as an image.
struct Part {
  Image<std::uint8_t> mask;
  Image<float> image;
};

Part part_of(const Image<std::uint8_t>& mask) {
  constexpr int kMargin = 8;  // wider than the blur of any stage
  Part part{largest_part(in_lps_order(mask), kMargin), {}};
  part.image = Image<float>(part.mask.grid);
  std::copy(part.mask.voxels.begin(), part.mask.voxels.end(), part.image.voxels.begin());
  return part;
}

Candidate candidate_of(Surface surface, int detail) {
  return {.surface = std::move(surface),
          .detail = detail,
          .reading = {.name = "mask", .sign = 1.0, .inside = 1.0, .outside = 0.0, .similarity = {}, .tissue = {}},
          .levels = {1.0, 0.0, {}, {}}};
}

/// To the boundary of the part, stage by stage: (detail, how far to look in mm). Ends before a stage that fails.
struct MaskFit {
  Surface surface;
  bool complete = true;
};

MaskFit fitted(const Image<float>& image, Candidate state, const std::vector<std::pair<int, double>>& stages) {
  const ExpertPoints none;
  GeometryCache geometry;
  const Observer nobody;
  const StageContext context{image, none, geometry, nobody};
  for (const auto& [detail, reach] : stages) {
    const Stage stage{.name = "mask",
                      .detail = detail,
                      .energies = {{energy::region, 1.0}, {energy::bending, 5e-6}, {energy::spacing, 0.3}},
                      .resolution = 0.0,
                      .smoothing = 0.7,
                      .reach = 5.0,
                      .max_steps = 15};
    const Candidate before = state;
    run_stage(context, {.stage = stage, .first_reach_mm = reach}, state);
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
  const Part part = part_of(mask);
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
  MaskFit fit = fitted(part.image, candidate_of(ellipsoid, 0), stages);
  if (fit.complete) return fit.surface;
  // Long and bent: the ellipsoid lies across it.
  return from_voxels(part, voxels, choice).value_or(std::move(fit.surface));
}

}  // namespace pellicle
