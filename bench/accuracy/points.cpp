// Expert points: 200 points on the border of a label, with the image's forces, alone, and the image alone. The labels
// of AAL were drawn on a mean head, not on the edges of this one; those of the subcortical volume are FreeSurfer's.
#include <fmt/format.h>

#include "pellicle/energies/energy_kinds.h"
#include "pellicle/fit/expert_points.h"
#include "pellicle/image/files/volume_file.h"
#include "pellicle/image/reorder.h"
#include "pellicle/job/seeds.h"
#include "pellicle/mask/overlap.h"
#include "pellicle/mask/parts.h"
#include "pellicle/mesh/distance.h"
#include "pellicle/raster/rasterize.h"
#include "sections.h"

namespace pellicle::bench {

namespace {

constexpr int kPoints = 200;

Image<std::uint8_t> labels_between(const LabelVolume& labels, int first, int last) {
  Image<std::uint8_t> mask(labels.labels.grid);
  for (std::size_t i = 0; i < mask.voxels.size(); ++i) {
    const std::int32_t v = labels.labels.voxels[i];
    mask.voxels[i] = v >= first && v <= last ? 1 : 0;
  }
  keep_largest_part(mask);
  return mask;
}

struct Way {
  const char* name;
  bool points, image;
};

void rows_for(const std::string& object, const Image<float>& image, const Image<std::uint8_t>& truth) {
  const TriangleMesh border = surface_of_mask(truth);
  const ExpertPoints points{.points = sample_surface(border, kPoints)};
  SeedSphere seed;
  for (const Vec3& x : points.points) seed.center += x / kPoints;
  for (const Vec3& x : points.points) seed.radius += 0.5 * (x - seed.center).norm() / kPoints;
  const double h = image.grid.mean_spacing();
  for (const ModelKind kind : {ModelKind::normal, ModelKind::catmull_clark}) {
    for (const Way& way :
         {Way{"image and points", true, true}, Way{"points alone", true, false}, Way{"image alone", false, true}}) {
      FitOptions settings;
      settings.model.kind = kind;
      if (!way.image) settings.energies = {{energy::region, 0.0}, {energy::edge, 0.0}};
      const double begin = seconds_now();
      const Seed start = way.points ? seed_of_points(points, image.grid, settings).value_or(seed) : Seed(seed);
      const FitResult fit = fit_surface({image, {start}, way.points ? points : ExpertPoints{}}, settings);
      const double seconds = seconds_now() - begin;
      const TriangleMesh mesh = measuring_mesh(fit.surface, h);
      const PointDistances off = distances_to(points, fit.surface, h);
      fmt::print("| {} | {} | {} | {} | {:.3f} | {:.2f} | {:.2f} | {:.2f} | {} | {:.2f} |\n", object,
                 model_name(fit.surface.model), way.name, control_point_count(fit.surface.model),
                 overlap_of(truth, rasterize_mask(mesh, truth.grid)).dice, surface_distances(mesh, border, h).assd,
                 off.rms_mm, off.max_mm, to_string(fit.summary.status), seconds);
      std::fflush(stdout);
    }
  }
}

}  // namespace

void points_table(const Options& options) {
  fmt::print("\n## Expert points: {} on the border of a label\n\n", kPoints);
  fmt::print(
      "| object | model | forces | control points | Dice | ASSD (mm) | points rms (mm) | max | status | seconds |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n");
  if (std::filesystem::exists(options.head / "aal.nii.gz")) {
    rows_for("cerebellum of ch2, AAL 91 to 116", in_lps_order(read_volume(options.head / "ch2.nii.gz").image),
             labels_between(read_labels(options.head / "aal.nii.gz"), 91, 116));
  } else {
    fmt::print("skipped: no aal.nii.gz in {} (Debian package mricron-data)\n", options.head.string());
  }
  const std::filesystem::path folder = options.data / "subcortical";
  if (std::filesystem::exists(folder)) {
    const Image<float> image = in_lps_order(read_volume(folder / "vxm_DERIVED_vol.nii.gz").image);
    const LabelVolume labels = read_labels(folder / "vxm_DERIVED_seg.nii.gz");
    rows_for("left caudate, label 11", image, labels_between(labels, 11, 11));
    rows_for("right caudate, label 50", image, labels_between(labels, 50, 50));
  } else {
    fmt::print("skipped: no folder {}\n", folder.string());
  }
}

}  // namespace pellicle::bench
