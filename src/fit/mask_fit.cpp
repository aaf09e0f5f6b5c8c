#include "pellicle/base/errors.h"
#include "pellicle/fit/fit.h"
#include "pellicle/fit/stage.h"
#include "pellicle/image/reorder.h"
#include "pellicle/seed/components.h"

namespace pellicle {

Surface surface_from_mask(const Image<std::uint8_t>& mask, const ModelChoice& choice, int detail) {
  const Image<std::uint8_t> ordered = in_lps_order(mask);
  const Components components = components_of(ordered);
  if (components.parts.empty()) throw BadData("the seed mask is empty");
  Image<std::uint8_t> part(ordered.grid);
  Image<float> image(ordered.grid);
  for (std::size_t i = 0; i < part.voxels.size(); ++i) {
    part.voxels[i] = components.labels.voxels[i] == 1 ? 1 : 0;
    image.voxels[i] = part.voxels[i];
  }
  const Moments moments = moments_of(part);
  const SurfaceModel model = start_model(choice);
  FitState state{
      .surface = {model, on_ellipsoid(model, moments.centroid, moments.shape)},
      .reading = {.name = "mask", .sign = 1.0, .inside = 1.0, .outside = 0.0, .similarity = {}, .tissue = {}},
      .levels = {1.0, 0.0, {}, {}},
      .reason = {}};
  const double radius = std::cbrt(std::abs(moments.shape.determinant()));
  FitSettings settings;
  GeometryCache geometry;
  const StageContext context{image, settings, geometry};
  for (int d = std::min(1, detail); d <= detail; ++d) {
    state.reach_mm = d <= 1 ? 0.6 * radius : 0.2 * radius;
    const Stage stage{.name = "mask",
                      .detail = d,
                      .energies = {{"region", 1.0}, {"bending", 5e-6}, {"spacing", 0.3}},
                      .resolution = 0.0,
                      .smoothing = 0.7,
                      .reach = 5.0,
                      .max_steps = 15};
    const FitState before = state;
    run_stage(context, stage, state);
    if (state.status != FitStatus::ok) return before.surface;
  }
  return state.surface;
}

}  // namespace pellicle
