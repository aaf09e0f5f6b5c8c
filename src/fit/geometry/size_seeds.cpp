#include "pellicle/fit/geometry/internal/size_seeds.h"

#include <algorithm>
#include <numbers>

#include "pellicle/mesh/distance.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/mesh/points/rim.h"
#include "pellicle/raster/rasterize.h"
#include "pellicle/seed/open_seed.h"
#include "pellicle/seed/seed_surface.h"

namespace pellicle {

namespace {

constexpr int kBodySamples = 10000, kBodySteps = 12;
constexpr double kBodySmoothness = 10.0;  ///< strong, because voxels are rough

}  // namespace

// Fraction of the body's surface that is not near the seed: limbs that it lacks.
double SizeSeeds::uncovered_fraction(const VoxelSeed& seed) {
  constexpr int kLooks = 1000;
  constexpr double kNear = 1.5;
  if (body_points_.empty()) body_points_ = sample_surface(surface_of_mask(input_.body), kLooks);
  const TriangleMesh mesh = split_quads(seed.mesh);
  const ClosestPoint nearest(mesh);
  const auto missed = std::count_if(body_points_.begin(), body_points_.end(),
                                    [&](const Vec3& x) { return nearest.query(x).distance > kNear * seed.spacing_mm; });
  return static_cast<double>(missed) / kLooks;
}

std::optional<VoxelSeed> SizeSeeds::on_grid(double spacing) {
  constexpr double kAllCovered = 0.01;
  std::optional<VoxelSeed> best;
  double least = 1.0;
  for (const double filled : {0.5, 0.6, 0.7, 0.8, 0.3, 0.15}) {
    Image<std::uint8_t> voxels = voxels_of_mask(input_.body, spacing, filled, Limbs::followed);
    if (std::all_of(voxels.voxels.begin(), voxels.voxels.end(), [](std::uint8_t v) { return v == 0; })) continue;
    VoxelSeed seed = voxel_seed_of_voxels(std::move(voxels));
    if (seed.genus != input_.genus) continue;
    const double uncovered = uncovered_fraction(seed);
    if (uncovered >= least) continue;
    least = uncovered;
    best = std::move(seed);
    if (least <= kAllCovered) break;
  }
  return best;
}

std::optional<VoxelSeed> SizeSeeds::next() {
  const Image<std::uint8_t>& body = input_.body;
  if (!(spacing_ > 0.0)) spacing_ = std::numbers::sqrt2 * coarsest_spacing(body);
  for (;;) {
    spacing_ /= std::numbers::sqrt2;
    if (spacing_ < 0.7 * body.grid.spacing.maxCoeff()) return std::nullopt;
    if (std::optional<VoxelSeed> seed = on_grid(spacing_)) return seed;
  }
}

Surface SizeSeeds::surface_on(const VoxelSeed& seed) {
  if (!input_.open) {
    if (!body_data_) body_data_ = data_of(surface_of_mask(input_.body), kBodySamples);
    PointFitSettings stiff;
    stiff.smoothness = kBodySmoothness * smoothness_;
    stiff.max_steps = kBodySteps;
    return at_rest(fit_from(*seed_surface(seed.mesh, model_), *body_data_, stiff, false, observer_).surface);
  }
  if (!tree_) {
    std::vector<Vec3> points;
    const std::vector<double>& weights = input_.data.weights;
    for (std::size_t k = 0; k < input_.data.points.size(); ++k) {
      if (weights.empty() || weights[k] > 0.0) points.push_back(input_.data.points[k]);
    }
    tree_ = std::make_unique<PointTree>(std::move(points));
    plane_normals_ = plane_normals(*tree_);
  }
  auto [model, parameters] = open_seed(seed.mesh, {*tree_, plane_normals_}, input_.data.rim, seed.spacing_mm);
  return {std::move(model), std::move(parameters)};
}

Surface SizeSeeds::first() {
  if (const std::optional<VoxelSeed> seed = next()) return surface_on(*seed);
  return surface_on(voxel_seed_of_mask(input_.body, input_.body.grid.spacing.maxCoeff()));
}

}  // namespace pellicle
