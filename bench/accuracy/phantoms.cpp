#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "otsu_baseline.h"
#include "pellicle/energies/profiles.h"
#include "pellicle/mask/overlap.h"
#include "pellicle/mesh/distance.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/raster/rasterize.h"
#include "phantom_cases.h"
#include "sections.h"

namespace pellicle::bench {

PhantomSettings phantom_case(const std::string& shape, std::size_t variant) {
  PhantomSettings s;
  s.shape = shape;
  s.size = {104, 104, 104};
  s.seed = 100 + variant;
  switch (variant) {
    case 1: {
      const double h = std::cbrt(0.5 * 0.5 * 1.5);
      s.spacing = {0.5, 0.5, 1.5};
      s.size = {150, 150, 50};
      s.direction_degrees = {20, -15, 30};
      s.radius = {20.0 * h};
      s.blur_mm = h;
      break;
    }
    case 2:
      std::swap(s.inside, s.outside);
      break;
    case 3:
      s.bias = 0.25;
      break;
    case 4:
      s.fill = PhantomFill::shell;
      break;
    default:
      break;
  }
  return s;
}

namespace {

FitOptions settings_for(const ModelChoice& model) {
  FitOptions settings;
  settings.model = model;
  return settings;
}

struct Row {
  std::vector<double> assd, dice, seconds, otsu;
  int ok = 0, runs = 0;
};

void run_case(const Phantom& phantom, const Options& options, Row& row) {
  const double h = phantom.image.grid.mean_spacing();
  RandomEngine random(phantom.settings.seed);
  for (const SeedDraw& seed : draw_seeds(phantom, options.seeds, random)) {
    const double begin = seconds_now();
    const FitResult fit =
        fit_surface({phantom.image, {SeedSphere{seed.center, seed.radius}}}, settings_for(options.model));
    row.seconds.push_back(seconds_now() - begin);
    const TriangleMesh mesh = measuring_mesh(fit.surface, h);
    row.assd.push_back(surface_distances(mesh, phantom.truth_surface, h).assd / h);
    row.dice.push_back(overlap_of(phantom.truth, rasterize_mask(mesh, phantom.image.grid)).dice);
    const auto kind = phantom.settings.fill == PhantomFill::shell ? OtsuObject::shell : OtsuObject::solid;
    row.otsu.push_back(overlap_of(phantom.truth, otsu_baseline(phantom.image, seed.center, kind)).dice);
    ++row.runs;
    row.ok += fit.summary.status == FitStatus::ok ? 1 : 0;
  }
}

}  // namespace

void phantom_table(const Options& options) {
  fmt::print(
      "\n## Phantoms\n\nRadius about 20 voxels, SNR 5, blur 1 voxel, {} seeds a case, --model {}, no other setting "
      "given.\n\n",
      options.seeds, model_name(start_model(options.model)));
  fmt::print(
      "| shape | case | status ok | ASSD median | ASSD worst | Dice worst | Otsu Dice | seconds (median) "
      "|\n|---|---|---|---|---|---|---|---|\n");
  std::vector<double> all_assd, all_dice;
  int ok = 0, runs = 0;
  for (const std::string shape : kShapes) {
    if (!options.only.empty() && options.only != shape) continue;
    for (std::size_t v = 0; v < kVariants.size(); ++v) {
      Row row;
      run_case(make_phantom(phantom_case(shape, v)), options, row);
      fmt::print("| {} | {} | {}/{} | {:.3f} | {:.3f} | {:.4f} | {:.4f} | {:.2f} |\n", shape, kVariants[v], row.ok,
                 row.runs, median_of(row.assd), *std::max_element(row.assd.begin(), row.assd.end()),
                 *std::min_element(row.dice.begin(), row.dice.end()), median_of(row.otsu), median_of(row.seconds));
      std::fflush(stdout);
      all_assd.insert(all_assd.end(), row.assd.begin(), row.assd.end());
      all_dice.insert(all_dice.end(), row.dice.begin(), row.dice.end());
      ok += row.ok;
      runs += row.runs;
    }
  }
  if (runs == 0) return;
  fmt::print("| **all** | | {}/{} | {:.3f} | {:.3f} | {:.4f} | | |\n", ok, runs, median_of(all_assd),
             *std::max_element(all_assd.begin(), all_assd.end()), *std::min_element(all_dice.begin(), all_dice.end()));
}

void clean_sphere_table(const Options& options) {
  PhantomSettings s;
  s.noise = PhantomNoise::none;
  const Phantom phantom = make_phantom(s);
  const double h = phantom.image.grid.mean_spacing();
  const SeedDraw seed = phantom.seeds.front();
  const FitResult fit =
      fit_surface({phantom.image, {SeedSphere{seed.center, seed.radius}}}, settings_for(options.model));
  const TriangleMesh mesh = measuring_mesh(fit.surface, h);
  const Image<std::uint8_t> mask = rasterize_mask(mesh, phantom.image.grid);
  const double truth = 1000.0 * phantom.exact_volume_ml;
  const double in_mask = overlap_of(phantom.truth, mask).result_volume;
  fmt::print(
      "\n## Noise-free sphere\n\n| ASSD (voxel) | volume error of the surface | of the mask | of the truth's own mask "
      "|\n|---|---|---|---|\n");
  fmt::print("| {:.4f} | {:+.3f} % | {:+.3f} % | {:+.3f} % |\n",
             surface_distances(mesh, phantom.truth_surface, h).assd / h,
             100.0 * (volume_with_normals(mesh) / truth - 1.0), 100.0 * (in_mask / truth - 1.0),
             100.0 * (overlap_of(phantom.truth, mask).truth_volume / truth - 1.0));
}

}  // namespace pellicle::bench
