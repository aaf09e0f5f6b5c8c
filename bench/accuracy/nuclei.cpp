// Many nuclei: phantoms and real stacks, `pellicle segment --objects many` with its defaults, beside Otsu's threshold
// and a watershed of the distance to the background, one setting for all.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "otsu_baseline.h"
#include "pellicle/energies/profiles.h"
#include "pellicle/image/files/volume_file.h"
#include "pellicle/image/resample.h"
#include "pellicle/seed/territories.h"
#include "pellicle/synthetic/cluster.h"
#include "sections.h"

namespace pellicle::bench {

namespace {

using Labels = std::vector<int>;

struct NucleiScores {
  std::size_t truth = 0, found = 0, visible = 0;
  double f1 = 0.0, dice = 0.0, f1_visible = 0.0;
};

/// Voxel counts of labels and pairs.
struct Overlaps {
  std::map<int, double> truth, result;
  std::map<std::pair<int, int>, double> both;
  Overlaps(const Labels& t, const Labels& r) {
    for (std::size_t i = 0; i < t.size(); ++i) {
      if (t[i] != 0) truth[t[i]] += 1.0;
      if (r[i] != 0) result[r[i]] += 1.0;
      if (t[i] != 0 && r[i] != 0) both[{t[i], r[i]}] += 1.0;
    }
  }
  double iou(const std::pair<int, int>& pair, double shared) const {
    return shared / (truth.at(pair.first) + result.at(pair.second) - shared);
  }
};

/// True labels above a quarter of the median volume of those that do not touch the border.
std::set<int> visible_labels(const Labels& truth, const Index3& size, const Overlaps& o) {
  std::set<int> border;
  std::size_t n = 0;
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i, ++n) {
        if (i == 0 || j == 0 || k == 0 || i == size[0] - 1 || j == size[1] - 1 || k == size[2] - 1)
          border.insert(truth[n]);
      }
    }
  }
  std::vector<double> interior, all;
  for (const auto& [label, count] : o.truth) {
    all.push_back(count);
    if (!border.contains(label)) interior.push_back(count);
  }
  const double least = 0.25 * median_of(interior.empty() ? all : interior);
  std::set<int> visible;
  for (const auto& [label, count] : o.truth) {
    if (count > least) visible.insert(label);
  }
  return visible;
}

/// Pairs with IoU of one half or more are matches (each label has one at most, or ties at exactly one half). Slivers at
/// the border count neither for nor against in `f1_visible`, nor do results that lie in them.
NucleiScores score(const Labels& truth, const Labels& result, const Index3& size) {
  const Overlaps o(truth, result);
  const std::set<int> visible = visible_labels(truth, size, o);
  NucleiScores s{o.truth.size(), o.result.size(), visible.size()};
  std::map<int, double> best;
  std::map<int, std::pair<double, int>> partner;
  std::set<int> matched_truth, matched_result, in_visible;
  for (const auto& [pair, shared] : o.both) {
    const double iou = o.iou(pair, shared);
    best[pair.first] = std::max(best[pair.first], 2.0 * shared / (o.truth.at(pair.first) + o.result.at(pair.second)));
    partner[pair.second] = std::max(partner[pair.second], {iou, pair.first});
    if (iou < 0.5 || matched_truth.contains(pair.first) || matched_result.contains(pair.second)) continue;
    matched_truth.insert(pair.first);
    matched_result.insert(pair.second);
    if (visible.contains(pair.first)) in_visible.insert(pair.first);
  }
  for (const auto& [label, dice] : best) s.dice += dice / static_cast<double>(s.truth);
  s.f1 = 2.0 * static_cast<double>(matched_truth.size()) /
         static_cast<double>(std::max<std::size_t>(1, s.truth + s.found));
  std::size_t counted = 0;
  for (const auto& [label, count] : o.result) {
    const auto at = partner.find(label);
    counted += at == partner.end() || visible.contains(at->second.second) ? 1 : 0;
  }
  s.f1_visible = 2.0 * static_cast<double>(in_visible.size()) /
                 static_cast<double>(std::max<std::size_t>(1, visible.size() + counted));
  return s;
}

/// Distance in mm from each voxel of the mask to the nearest outside, by two passes of a 3x3x3 chamfer.
Image<float> distance_inside(const Image<std::uint8_t>& mask) {
  const Index3& size = mask.grid.size;
  Image<float> d(mask.grid);
  for (std::size_t i = 0; i < mask.voxels.size(); ++i) d.voxels[i] = mask.voxels[i] != 0 ? 1e30F : 0.0F;
  for (const int direction : {1, -1}) {
    for (int kk = 0; kk < size[2]; ++kk) {
      for (int jj = 0; jj < size[1]; ++jj) {
        for (int ii = 0; ii < size[0]; ++ii) {
          const int i = direction > 0 ? ii : size[0] - 1 - ii, j = direction > 0 ? jj : size[1] - 1 - jj,
                    k = direction > 0 ? kk : size[2] - 1 - kk;
          float& here = d.at(i, j, k);
          for (int n = 0; n < 13 && here > 0.0F; ++n) {  // the neighbours that were there before
            const int x = n % 3 - 1, y = n / 3 % 3 - 1, z = n / 9 - 1;
            const int a = i + direction * x, b = j + direction * y, c = k + direction * z;
            if (a < 0 || b < 0 || c < 0 || a >= size[0] || b >= size[1] || c >= size[2]) continue;
            const auto step = static_cast<float>(Vec3(x, y, z).cwiseProduct(mask.grid.spacing).norm());
            here = std::min(here, d.at(a, b, c) + step);
          }
        }
      }
    }
  }
  return d;
}

/// Otsu's threshold of the image smoothed by a voxel, distance to the background smoothed by a voxel and a half, one
/// object a maximum of it, watershed.
Labels threshold_and_watershed(const Image<float>& image) {
  const double h = image.grid.mean_spacing();
  const Image<float> smooth = gaussian_smooth(image, h);
  const double threshold = otsu_threshold(smooth);
  Image<std::uint8_t> mask(image.grid);
  for (std::size_t i = 0; i < mask.voxels.size(); ++i)
    mask.voxels[i] = static_cast<double>(smooth.voxels[i]) > threshold ? 1 : 0;
  const Image<float> distance = gaussian_smooth(distance_inside(mask), 1.5 * h);
  const Index3& size = image.grid.size;
  std::vector<Vec3> seeds;
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i) {
        if (mask.at(i, j, k) == 0 || !(static_cast<double>(distance.at(i, j, k)) > 2.0 * h)) continue;
        bool top = true;
        for (int n = 0; n < 27 && top; ++n) {
          const int a = i + n % 3 - 1, b = j + n / 3 % 3 - 1, c = k + n / 9 - 1;
          if (n == 13 || a < 0 || b < 0 || c < 0 || a >= size[0] || b >= size[1] || c >= size[2]) continue;
          top = n < 13 ? distance.at(a, b, c) < distance.at(i, j, k) : distance.at(a, b, c) <= distance.at(i, j, k);
        }
        if (top) seeds.push_back(image.grid.world_from_index(Vec3(i, j, k)));
      }
    }
  }
  Labels labels(mask.voxels.size(), 0);
  if (seeds.empty()) return labels;
  const Image<std::int32_t> owner = territories_of(distance, seeds);
  for (std::size_t i = 0; i < labels.size(); ++i) labels[i] = mask.voxels[i] != 0 ? owner.voxels[i] : 0;
  return labels;
}

Labels as_labels(const auto& voxels) {
  return Labels(voxels.begin(), voxels.end());
}

void print_row(const std::string& name, const NucleiScores& ours, const std::optional<NucleiScores>& threshold,
               double seconds, double megabytes) {
  const std::string beside = threshold ? fmt::format("{} | {:.3f} | {:.3f} | {:.3f}", threshold->found, threshold->f1,
                                                     threshold->dice, threshold->f1_visible)
                                       : "not run | | |";
  fmt::print("| {} | {} | {} | {:.3f} | {:.3f} | {:.3f} ({}) | {} | {:.1f} | {:.0f} |\n", name, ours.truth, ours.found,
             ours.f1, ours.dice, ours.f1_visible, ours.visible, beside, seconds, megabytes);
  std::fflush(stdout);
}

/// Runs the program as a user does, so that time and memory are those from file to files.
void run_case(const Options& options, const std::string& name, const std::filesystem::path& input,
              const std::vector<double>& spacing, const Labels& truth, bool baseline) {
  const std::filesystem::path out = options.scratch / "nuclei";
  std::string command = fmt::format("{} segment -q -i '{}' -o '{}' --name n --objects many --overwrite",
                                    PELLICLE_PROGRAM, input.string(), out.string());
  if (!spacing.empty()) command += fmt::format(" --spacing {},{},{}", spacing[0], spacing[1], spacing[2]);
  const double begin = seconds_now();
  const int status = std::system((command + " > /dev/null 2>&1").c_str());
  const double seconds = seconds_now() - begin;
  if (status != 0 && WEXITSTATUS(status) != 3) {
    fmt::print("| {} | failed |\n", name);
    return;
  }
  const auto report = nlohmann::json::parse(std::ifstream(out / "n_report.json"));
  const LabelVolume result = read_labels(out / "n_dseg.nii.gz");
  std::optional<NucleiScores> without;
  if (baseline) {
    ReadOptions read;
    if (!spacing.empty()) read.spacing = Vec3(spacing[0], spacing[1], spacing[2]);
    const Volume volume = read_volume(input, read);
    without = score(truth, threshold_and_watershed(volume.image), volume.image.grid.size);
  }
  print_row(name, score(truth, as_labels(result.labels.voxels), result.labels.grid.size), without, seconds,
            report["peak_memory_bytes"].get<double>() / 1e6);
  std::filesystem::remove_all(out);
}

ClusterSettings phantom(int count, const Index3& size, const Vec3& spacing, double snr, std::uint64_t seed) {
  ClusterSettings s;
  s.image.size = size;
  s.image.spacing = spacing;
  s.image.snr = snr;
  s.image.seed = seed;
  s.count = count;
  return s;
}

}  // namespace

void nuclei_table(const Options& options) {
  fmt::print(
      "\n## Many nuclei, --objects many\n\nNo seeds, no setting a set but the voxel size where the file has none. F1 "
      "at IoU "
      "0.5; Dice: mean over all true labels of the best overlap; visible: labels above 25 % of the median interior "
      "volume. "
      "Threshold: Otsu, distance transform, watershed, one setting for all.\n\n| set | true | found | F1 | Dice | F1 "
      "visible "
      "(n) | threshold: found | F1 | Dice | F1 visible | seconds | MB "
      "|\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  ClusterSettings dim = phantom(40, {200, 200, 80}, {0.4, 0.4, 1.0}, 8.0, 2);
  dim.contrast_min = 0.1;
  ClusterSettings touching = phantom(150, {240, 240, 96}, {0.4, 0.4, 1.0}, 8.0, 3);
  touching.distance = 0.88;
  const std::vector<std::pair<std::string, ClusterSettings>> phantoms{
      {"40 nuclei", phantom(40, {160, 160, 80}, {0.4, 0.4, 1.0}, 8.0, 1)},
      {"contrast varying 10x", dim},
      {"150 touching", touching},
      {"1:5 anisotropy, SNR 3", phantom(60, {320, 320, 50}, {0.3, 0.3, 1.5}, 3.0, 4)},
      {"1000 nuclei", phantom(1000, {512, 512, 200}, {0.4, 0.4, 1.0}, 8.0, 9)}};
  for (const auto& [name, settings] : phantoms) {
    Labels truth;
    const std::filesystem::path file = options.scratch / "nuclei.nii.gz";
    {
      const Cluster cluster = make_cluster(settings);
      truth = as_labels(cluster.truth.voxels);
      VolumeHeader header;
      header.grid = cluster.image.grid;
      Image<std::int16_t> stored(cluster.image.grid);
      std::transform(cluster.image.voxels.begin(), cluster.image.voxels.end(), stored.voxels.begin(),
                     [](float v) { return static_cast<std::int16_t>(std::lround(10.0F * v)); });
      write_volume(file, stored, header);
    }
    run_case(options, name, file, {}, truth, settings.count < 1000);
    std::filesystem::remove(file);
  }
  struct Real {
    const char *name, *image, *truth;
    std::vector<double> spacing;
  };
  const std::vector<Real> stacks{
      {"ovule 1135", "nuclei-ovule/1135_DERIVED_raw.tif", "nuclei-ovule/1135_DERIVED_label.tif", {}},
      {"ovule 1136", "nuclei-ovule/1136_DERIVED_raw.tif", "nuclei-ovule/1136_DERIVED_label.tif", {}},
      {"embryo, 8 cells", "nuclei-embryo/8cell_raw.tif", "nuclei-embryo/8cell_DERIVED_instances.tif", {1, 1, 2.18}},
      {"worm", "nuclei-worm/img3d.tif", "nuclei-worm/mask3d.tif", {1, 1, 2}}};
  for (const Real& stack : stacks) {
    if (!std::filesystem::exists(options.data / stack.image)) {
      fmt::print("| {} | no data |\n", stack.name);
      continue;
    }
    run_case(options, stack.name, options.data / stack.image, stack.spacing,
             as_labels(read_labels(options.data / stack.truth).labels.voxels), true);
  }
}

}  // namespace pellicle::bench
