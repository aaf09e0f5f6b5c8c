// The torus phantom (major 26, minor 9 voxels) with --model spline-torus, from tori off by 30 % of the minor radius.
#include <fmt/format.h>

#include <algorithm>

#include "pellicle/energies/profiles.h"
#include "pellicle/mask/overlap.h"
#include "pellicle/mesh/distance.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/raster/rasterize.h"
#include "pellicle/synthetic/phantom.h"
#include "sections.h"

namespace pellicle::bench {

namespace {

PhantomSettings torus_phantom(std::size_t variant) {
  PhantomSettings s;
  s.shape = "torus";
  s.size = {96, 96, 56};
  s.radius = {26.0, 9.0};
  s.seed = 300 + variant;
  if (variant == 1) {
    s.size = {120, 120, 80};
    s.direction_degrees = {20, -15, 30};
    s.spacing = {0.8, 0.8, 1.2};
  }
  if (variant == 2) std::swap(s.inside, s.outside);
  if (variant == 3) s.bias = 0.25;
  return s;
}

// The phantom's own size and pose, moved by `off` mm in a random direction and turned by up to ten degrees.
Surface torus_seed(const Phantom& phantom, double off, RandomEngine& random) {
  const double major = phantom.settings.radius[0], minor = phantom.settings.radius[1];
  const SurfaceModel model =
      SplineModel({.topology = SplineTopology::torus, .m1 = 6, .m2 = 4, .reference_ratio = minor / major});
  const Vec3 direction = Vec3(random.normal(), random.normal(), random.normal()).normalized();
  const Vec3 axis = Vec3(random.normal(), random.normal(), random.normal()).normalized();
  const Mat3 turn = Eigen::AngleAxisd(random.uniform(0.0, 0.17), axis).toRotationMatrix();
  return {model,
          affine_image(model, phantom.body.center + off * direction, major * turn * phantom.body.world_from_shape)};
}

}  // namespace

void torus_table(const Options& options) {
  fmt::print(
      "\n## Torus, --model spline-torus\n\nMajor radius 26, minor 9 voxels, SNR 5, blur 1 voxel; {} seeds a case: tori "
      "off by 30 % of the minor radius in any direction and turned by up to ten degrees.\n\n| case | status ok | genus "
      "1 | "
      "ASSD median | ASSD worst | Dice of the seeds | Dice worst | seconds (median) "
      "|\n|---|---|---|---|---|---|---|---|\n",
      options.seeds);
  FitOptions settings;
  settings.model.kind = ModelKind::spline_torus;
  constexpr const char* kVariants[] = {"isotropic", "0.8x0.8x1.2 oblique", "dark on bright", "25 % bias"};
  for (std::size_t v = 0; v < std::size(kVariants); ++v) {
    const Phantom phantom = make_phantom(torus_phantom(v));
    const double h = phantom.image.grid.mean_spacing();
    RandomEngine random(phantom.settings.seed);
    std::vector<double> assd, dice, seed_dice, seconds;
    int ok = 0, genus = 0;
    for (int i = 0; i < options.seeds; ++i) {
      const Surface seed = torus_seed(phantom, 0.3 * phantom.settings.radius[1], random);
      const double begin = seconds_now();
      const FitResult fit = fit_surface({phantom.image, {seed}}, settings);
      seconds.push_back(seconds_now() - begin);
      const TriangleMesh mesh = measuring_mesh(fit.surface, h);
      assd.push_back(surface_distances(mesh, phantom.truth_surface, h).assd / h);
      dice.push_back(overlap_of(phantom.truth, rasterize_mask(mesh, phantom.image.grid)).dice);
      seed_dice.push_back(overlap_of(phantom.truth, rasterize_mask(measuring_mesh(seed, h), phantom.image.grid)).dice);
      ok += fit.summary.status == FitStatus::ok ? 1 : 0;
      genus += topology_of(mesh).genus == 1 ? 1 : 0;
    }
    fmt::print("| {} | {}/{} | {}/{} | {:.3f} | {:.3f} | {:.2f} | {:.4f} | {:.2f} |\n", kVariants[v], ok, options.seeds,
               genus, options.seeds, median_of(assd), *std::max_element(assd.begin(), assd.end()), median_of(seed_dice),
               *std::min_element(dice.begin(), dice.end()), median_of(seconds));
    std::fflush(stdout);
  }
}

}  // namespace pellicle::bench
