// Organs, tumours and hippocampi from one click each: a sphere of 5 mm. Nothing but its place comes from the truth.

#include <fmt/format.h>

#include <cstdio>

#include "click.h"
#include "otsu_baseline.h"
#include "pellicle/energies/geometry.h"
#include "pellicle/energies/profiles.h"
#include "pellicle/image/files/volume_file.h"
#include "pellicle/image/reorder.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/settings/presets.h"
#include "pellicle/settings/settings_toml.h"
#include "sections.h"

namespace pellicle::bench {

namespace {

constexpr double kClick = 5.0;  // mm

FitOptions settings_of_preset(const std::string& name) {
  SegmentSettings settings;
  apply_toml_file(find_preset(name), settings);
  return settings.fit;
}

void print_click_head() {
  fmt::print(
      "| case | Dice | volume error | Dice without a preset | Otsu | best window, by the truth | reading | evidence | "
      "status | seconds |\n|---|---|---|---|---|---|---|---|---|---|\n");
}

/// Dice of the preset.
double click_row(const std::string& name, const Image<float>& image, const Image<std::uint8_t>& truth,
                 const Vec3& place, const FitOptions& settings) {
  const SeedSphere seed{place, kClick};
  const double begin = seconds_now();
  const FitResult fit = fit_surface({image, {seed}}, settings);
  const double seconds = seconds_now() - begin;
  const OverlapMetrics overlap = overlap_with(truth, fit.surface);
  const double plain = overlap_with(truth, fit_surface({image, {seed}}, FitOptions{}).surface).dice;
  const double otsu = overlap_of(truth, otsu_baseline(image, place, OtsuObject::solid)).dice;
  std::string reading;
  for (const auto& h : fit.summary.hypotheses) reading = h.chosen ? h.name : reading;
  fmt::print("| {} | {:.3f} | {:+.0f} % | {:.3f} | {:.3f} | {:.3f} | {} | {:.2f} | {} | {:.1f} |\n", name, overlap.dice,
             100.0 * overlap.volume_error.value_or(0.0), plain, otsu, best_window_dice(image, truth), reading,
             fit.summary.evidence.score, to_string(fit.summary.status), seconds);
  std::fflush(stdout);
  return overlap.dice;
}

bool missing(const std::filesystem::path& folder) {
  if (std::filesystem::exists(folder)) return false;
  fmt::print("skipped: no folder {}\n", folder.string());
  return true;
}

double mean_of(const std::vector<double>& values) {
  return values.empty() ? 0.0 : sum(values) / static_cast<double>(values.size());
}

/// Dice of fits that start from spheres placed by one rule.
struct Start {
  std::string name;
  std::vector<double> ok, not_ok, otsu;  ///< fits by their status; Otsu's component under the same place

  void add(const Image<float>& image, const Image<std::uint8_t>& truth, const Vec3& place) {
    const FitResult fit = fit_surface({image, {SeedSphere{place, kClick}}}, FitOptions{});
    // As the program says it: a surface that cuts itself is not ok.
    const bool sound = self_intersection_count(measuring_mesh(fit.surface, image.grid.mean_spacing())) == 0;
    (fit.summary.status == FitStatus::ok && sound ? ok : not_ok).push_back(overlap_with(truth, fit.surface).dice);
    otsu.push_back(overlap_of(truth, otsu_baseline(image, place, OtsuObject::solid)).dice);
  }
};

void sarcoma_clicks(const Options& options) {
  fmt::print("\n## Sarcoma, one click, --preset lesion\n\n");
  const std::filesystem::path folder = options.data / "sarcoma";
  if (missing(folder)) return;
  print_click_head();
  std::vector<double> dice;
  for (const std::string name : {"STS_002_CT", "STS_003_CT", "STS_002_MR_T1", "STS_003_MR_T1"}) {
    const Image<float> image = in_lps_order(read_volume(folder / (name + "_image.nii.gz")).image);
    const auto truth = mask_of_labels(read_labels(folder / (name + "_mask.nii.gz")).labels);
    dice.push_back(click_row(name, image, truth, deepest_point(truth), settings_of_preset("lesion")));
  }
  fmt::print("| **median** | {:.3f} | | | | | | | | |\n", median_of(dice));
}

}  // namespace

void organ_table(const Options& options) {
  fmt::print("\n## Organs in CT, one click, --preset organ-ct\n\n");
  const std::filesystem::path folder = options.data / "organs-ct";
  if (!missing(folder)) {
    const Image<float> image = in_lps_order(read_volume(folder / "example_ct.nii.gz").image);
    const Image<std::int32_t> labels = read_labels(folder / "example_seg_fullres_v1labels.nii.gz").labels;
    print_click_head();
    std::vector<double> dice;
    for (const auto& [name, label] : std::vector<std::pair<std::string, int>>{
             {"spleen", 1}, {"kidney R", 2}, {"kidney L", 3}, {"liver", 5}, {"bladder", 104}}) {
      const auto truth = mask_of_labels(labels, {label});
      dice.push_back(click_row(name, image, truth, deepest_point(truth), settings_of_preset("organ-ct")));
    }
    fmt::print("| **median** | {:.3f} | | | | | | | | |\n", median_of(dice));
  }
  sarcoma_clicks(options);
}

void hippocampus_table(const Options& options) {
  fmt::print("\n## Hippocampus, a sphere of 5 mm, no preset\n\n");
  const std::filesystem::path folder = options.data / "hippocampus";
  if (missing(folder)) return;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "images")) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  Start middle{"at the middle of the crop", {}, {}, {}}, click{"at the deepest point of the label", {}, {}, {}};
  std::vector<double> window;
  for (const auto& file : files) {
    const Image<float> image = in_lps_order(read_volume(file).image);
    const auto truth = mask_of_labels(read_labels(folder / "labels" / file.filename()).labels);
    const Index3& size = image.grid.size;
    middle.add(image, truth, image.grid.world_from_index(0.5 * Vec3(size[0] - 1, size[1] - 1, size[2] - 1)));
    click.add(image, truth, deepest_point(truth));
    window.push_back(best_window_dice(image, truth));
  }
  const auto row = [](const std::string& name, const std::vector<double>& dice) {
    fmt::print("| {} | {} | {:.3f} | {:.3f} | {:.3f} |\n", name, dice.size(), mean_of(dice),
               dice.empty() ? 0.0 : *std::min_element(dice.begin(), dice.end()),
               dice.empty() ? 0.0 : *std::max_element(dice.begin(), dice.end()));
  };
  fmt::print("| | crops | mean Dice | worst | best |\n|---|---|---|---|---|\n");
  for (const Start& start : {middle, click}) {
    std::vector<double> fitted = start.ok;
    fitted.insert(fitted.end(), start.not_ok.begin(), start.not_ok.end());
    row("fitted, sphere " + start.name, fitted);
    row("... of these, status ok", start.ok);
    row("... of these, another status", start.not_ok);
    row("Otsu's component " + start.name, start.otsu);
  }
  row("best window within 5 mm, by the truth", window);
}

}  // namespace pellicle::bench
