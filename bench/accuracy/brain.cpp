#include <fmt/format.h>

#include "pellicle/image/files/volume_file.h"
#include "pellicle/mask/overlap.h"
#include "pellicle/mask/parts.h"
#include "pellicle/mesh/distance.h"
#include "pellicle/raster/rasterize.h"
#include "sections.h"

namespace pellicle::bench {

namespace {
Image<std::uint8_t> largest_part(const Image<float>& image) {
  Image<std::uint8_t> mask(image.grid);
  for (std::size_t i = 0; i < mask.voxels.size(); ++i) mask.voxels[i] = image.voxels[i] > 0.0F ? 1 : 0;
  keep_largest_part(mask);
  return mask;
}
}  // namespace

void brain_table(const Options& options) {
  fmt::print("\n## Brain of ch2, against BET\n\n");
  if (!std::filesystem::exists(options.head / "ch2.nii.gz")) {
    fmt::print("skipped: no ch2.nii.gz in {} (Debian package mricron-data)\n", options.head.string());
    return;
  }
  const double begin = seconds_now();
  const Volume volume = read_volume(options.head / "ch2.nii.gz");
  FitOptions settings;
  settings.model = options.model;
  settings.start_rule = StartRule::head;
  settings.polarity = Polarity::bright;
  settings.boundary = Boundary::step;
  const FitResult fit = fit_surface({volume.image, {find_head(volume.image)}}, settings);
  const double seconds = seconds_now() - begin;
  const Image<std::uint8_t> bet = largest_part(read_volume(options.head / "ch2bet.nii.gz").image);
  fmt::print(
      "| surface | control points | Dice | volume error | ASSD (mm) | seconds with reading "
      "|\n|---|---|---|---|---|---|\n");
  const TriangleMesh truth = surface_of_mask(bet);
  const auto row = [&](const char* name, const Surface& surface, const std::string& time) {
    const TriangleMesh mesh = measuring_mesh(surface, 1.0);
    const OverlapMetrics overlap = overlap_of(bet, rasterize_mask(mesh, bet.grid));
    fmt::print("| {} | {} | {:.4f} | {:+.1f} % | {:.2f} | {} |\n", name, control_point_count(surface.model),
               overlap.dice, 100.0 * overlap.volume_error.value_or(0.0), surface_distances(mesh, truth, 1.0).assd,
               time);
  };
  row("fitted to the image", fit.surface, fmt::format("{:.2f}", seconds));
  row("ceiling: the same surface fitted to BET's mask", surface_from_mask(bet, options.model, 3), "");
}

}  // namespace pellicle::bench
