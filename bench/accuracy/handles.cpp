// Objects with holes from voxels: torus phantoms from a threshold of the image, and a vertebra from its label.
#include <fmt/format.h>

#include <algorithm>

#include "click.h"
#include "pellicle/energies/profiles.h"
#include "pellicle/image/files/volume_file.h"
#include "pellicle/image/reorder.h"
#include "pellicle/mask/overlap.h"
#include "pellicle/mesh/distance.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/raster/rasterize.h"
#include "pellicle/synthetic/phantom.h"
#include "sections.h"

namespace pellicle::bench {

namespace {

constexpr ModelKind kKinds[] = {ModelKind::catmull_clark, ModelKind::slime, ModelKind::normal};

// The half level, voxel by voxel, noise and all: what a user has without any work.
Image<std::uint8_t> threshold_of(const Phantom& phantom) {
  const double level = 0.5 * (phantom.settings.inside + phantom.settings.outside);
  Image<std::uint8_t> mask(phantom.image.grid);
  for (std::size_t i = 0; i < mask.voxels.size(); ++i) {
    mask.voxels[i] = static_cast<double>(phantom.image.voxels[i]) > level ? 1 : 0;
  }
  return mask;
}

PhantomSettings handled_phantom(const std::string& shape, std::size_t variant) {
  PhantomSettings s;
  s.shape = shape;
  s.size = {112, 112, 64};
  s.seed = 500 + variant;
  if (variant == 1) {
    s.size = {128, 128, 96};
    s.direction_degrees = {20, -15, 30};
    s.spacing = {0.8, 0.8, 1.2};
  }
  return s;
}

struct Scores {
  std::vector<double> seed_dice, dice, assd, seconds;
  int ok = 0, genus = 0, points = 0;
};

void add(const Image<float>& image, const Image<std::uint8_t>& seed_mask, const Image<std::uint8_t>& truth,
         const TriangleMesh& truth_surface, int genus, ModelKind kind, Scores& scores) {
  FitOptions settings;
  settings.model.kind = kind;
  const double h = image.grid.mean_spacing(), begin = seconds_now();
  const Surface seed = surface_from_mask(seed_mask, settings.model, 2);
  const FitResult fit = fit_surface({image, {seed}}, settings);
  scores.seconds.push_back(seconds_now() - begin);
  const TriangleMesh mesh = measuring_mesh(fit.surface, h);
  scores.seed_dice.push_back(overlap_of(truth, rasterize_mask(measuring_mesh(seed, h), truth.grid)).dice);
  scores.dice.push_back(overlap_of(truth, rasterize_mask(mesh, truth.grid)).dice);
  scores.assd.push_back(surface_distances(mesh, truth_surface, h).assd / h);
  scores.ok += fit.summary.status == FitStatus::ok ? 1 : 0;
  scores.genus += topology_of(mesh).genus == genus ? 1 : 0;
  scores.points = control_point_count(fit.surface.model);
}

void print_row(const std::string& object, ModelKind kind, const Scores& s) {
  const auto least = [](const std::vector<double>& v) { return *std::min_element(v.begin(), v.end()); };
  fmt::print("| {} | {} | {} | {}/{} | {}/{} | {:.3f} | {:.4f} | {:.3f} | {:.2f} |\n", object,
             model_name(start_model({.kind = kind})), s.points, s.ok, s.dice.size(), s.genus, s.dice.size(),
             least(s.seed_dice), least(s.dice), median_of(s.assd), median_of(s.seconds));
  std::fflush(stdout);
}

}  // namespace

void handle_table(const Options& options) {
  fmt::print(
      "\n## Objects with holes, from voxels\n\nPhantoms: SNR 5, blur 1 voxel, the seed mask is the image above half "
      "level; {} draws of the noise a case.\n\n| object | model | control points | status ok | genus right | Dice of "
      "the "
      "seed, worst | Dice worst | ASSD median (voxel) | seconds (median) |\n|---|---|---|---|---|---|---|---|---|\n",
      std::min(options.seeds, 4));
  for (const std::string shape : {"torus", "double-torus"}) {
    for (const std::size_t variant : {0U, 1U}) {
      for (const ModelKind kind : kKinds) {
        Scores scores;
        for (int draw = 0; draw < std::min(options.seeds, 4); ++draw) {
          PhantomSettings settings = handled_phantom(shape, variant);
          settings.seed += 10 * static_cast<std::uint64_t>(draw);
          const Phantom phantom = make_phantom(settings);
          add(phantom.image, threshold_of(phantom), phantom.truth, phantom.truth_surface, shape == "torus" ? 1 : 2,
              kind, scores);
        }
        print_row(shape + (variant == 0 ? "" : ", 0.8x0.8x1.2 oblique"), kind, scores);
      }
    }
  }
  const std::filesystem::path folder = options.data / "organs-ct";
  if (!std::filesystem::exists(folder)) {
    fmt::print("vertebra skipped: no folder {}\n", folder.string());
    return;
  }
  const Image<float> ct = in_lps_order(read_volume(folder / "example_ct.nii.gz").image);
  const Image<std::uint8_t> truth =
      mask_of_labels(read_labels(folder / "example_seg_fullres_v1labels.nii.gz").labels, {23});
  Image<float> label(truth.grid);
  std::copy(truth.voxels.begin(), truth.voxels.end(), label.voxels.begin());
  for (const ModelKind kind : kKinds) {
    Scores scores;
    add(label, truth, truth, surface_of_mask(truth), 1, kind, scores);
    print_row("vertebra T12 from its label, refined to the label", kind, scores);
  }
  for (const ModelKind kind : kKinds) {
    Scores scores;
    add(ct, truth, truth, surface_of_mask(truth), 1, kind, scores);
    print_row("vertebra T12 from its label, in the CT at 3 mm", kind, scores);
  }
}

}  // namespace pellicle::bench
