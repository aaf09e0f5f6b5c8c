#include <fmt/format.h>

#include "click.h"
#include "pellicle/image/files/volume_file.h"
#include "pellicle/image/reorder.h"
#include "pellicle/mask/overlap.h"
#include "pellicle/raster/rasterize.h"
#include "sections.h"

namespace pellicle::bench {

namespace {

// The deepest voxel, and half the mean distance from there to the object's border.
SeedSphere one_click(const Image<std::uint8_t>& truth) {
  const TriangleMesh surface = surface_of_mask(truth);
  SeedSphere seed{deepest_point(truth), 0.0};
  double mean = 0.0;
  for (const Vec3& v : surface.vertices)
    mean += (v - seed.center).norm() / static_cast<double>(surface.vertices.size());
  seed.radius = 0.5 * mean;
  return seed;
}

}  // namespace

void sarcoma_table(const Options& options) {
  fmt::print("\n## Sarcoma, one sphere at the deepest point with half the mean radius\n\n");
  if (!std::filesystem::exists(options.data / "sarcoma")) {
    fmt::print("skipped: no folder {}\n", (options.data / "sarcoma").string());
    return;
  }
  fmt::print(
      "| case | Dice | volume error | chosen reading | evidence | margin | status | seconds "
      "|\n|---|---|---|---|---|---|---|---|\n");
  for (const std::string name : {"STS_002_CT", "STS_003_CT", "STS_002_MR_T1", "STS_003_MR_T1"}) {
    const Image<float> image = in_lps_order(read_volume(options.data / "sarcoma" / (name + "_image.nii.gz")).image);
    const auto truth = mask_of_labels(read_labels(options.data / "sarcoma" / (name + "_mask.nii.gz")).labels);
    const SeedSphere seed = one_click(truth);
    const double begin = seconds_now();
    const FitResult fit = fit_surface({image, {seed}}, FitOptions{});
    const double seconds = seconds_now() - begin;
    const OverlapMetrics overlap = overlap_of(truth, rasterize_mask(measuring_mesh(fit.surface, 1.0), truth.grid));
    std::string reading;
    for (const auto& h : fit.summary.hypotheses) reading = h.chosen ? h.name : reading;
    fmt::print("| {} | {:.3f} | {:+.0f} % | {} | {:.2f} | {:.2f} | {} | {:.2f} |\n", name, overlap.dice,
               100.0 * overlap.volume_error.value_or(0.0), reading, fit.summary.evidence.score, fit.summary.margin,
               to_string(fit.summary.status), seconds);
  }
}

}  // namespace pellicle::bench
