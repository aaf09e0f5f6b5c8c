#include "pellicle/seed/image_facts.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pellicle/image/resample.h"
#include "pellicle/seed/blob_scale_space.h"
#include "pellicle/seed/threshold.h"

namespace pellicle {

const std::vector<FactDescription>& fact_descriptions() {
  static const std::vector<FactDescription> list{
      {"blob_cover", "share of the foreground (Otsu) that lies within 1.3 typical radii of a blob's centre"},
      {"blobs", "number of blobs of the typical size; of bright ones, or of dark ones when those stand out"},
      {"dark", "1 when the histogram's low tail is the long one, so that objects are dark; else 0"},
      {"dark_border", "share of the outermost voxels below a tenth of the robust range"},
      {"field_max_mm", "longest edge of the volume"},
      {"field_min_mm", "shortest edge of the volume"},
      {"foreground_ml", "volume above a tenth of the robust range"},
      {"hounsfield",
       "share of voxels with the Hounsfield units of air (-1100 to -850) or of soft tissue (-200 to 200); "
       "0 where nothing is as dark as fat"},
      {"seeds", "number of objects that seeds were given for"},
      {"spacing_known", "1 when the file or the user says how large a voxel is, else 0"},
      {"voxel_mm", "cube root of the volume of a voxel"},
  };
  return list;
}

namespace {

constexpr double kFactVoxels = 4e6;  // more say nothing new

bool on_border(const Index3& size, int i, int j, int k) {
  return i == 0 || j == 0 || k == 0 || i == size[0] - 1 || j == size[1] - 1 || k == size[2] - 1;
}

double quantile_in(const std::vector<float>& sorted, double fraction) {
  return static_cast<double>(sorted[static_cast<std::size_t>(fraction * static_cast<double>(sorted.size() - 1))]);
}

double fraction_between(const std::vector<float>& sorted, float low, float high) {
  const auto first = std::lower_bound(sorted.begin(), sorted.end(), low),
             last = std::upper_bound(sorted.begin(), sorted.end(), high);
  return static_cast<double>(last - first) / static_cast<double>(sorted.size());
}

void add_intensity_facts(const Image<float>& image, Facts& facts) {
  std::vector<float> sorted = image.voxels;
  std::sort(sorted.begin(), sorted.end());
  const bool as_dark_as_fat = quantile_in(sorted, 0.001) < -50.0;
  const bool spread = quantile_in(sorted, 0.99) - quantile_in(sorted, 0.01) > 100.0;
  facts["hounsfield"] = as_dark_as_fat && spread
                            ? fraction_between(sorted, -1100.0F, -850.0F) + fraction_between(sorted, -200.0F, 200.0F)
                            : 0.0;
  // The robust range, and the tenth of it above which a head begins (Smith 2002).
  const double low = quantile_in(sorted, 0.02), high = quantile_in(sorted, 0.98);
  const auto tenth = static_cast<float>(low + 0.1 * (high - low));
  const auto above = static_cast<double>(sorted.end() - std::upper_bound(sorted.begin(), sorted.end(), tenth));
  facts["foreground_ml"] = above * image.grid.voxel_volume() / 1000.0;
  const Index3& size = image.grid.size;
  double dark = 0.0, border = 0.0;
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i) {
        if (!on_border(size, i, j, k)) continue;
        border += 1.0;
        dark += image.at(i, j, k) <= tenth ? 1.0 : 0.0;
      }
    }
  }
  facts["dark_border"] = dark / border;
}

void add_blob_facts(const Image<float>& image, Facts& facts) {
  const bool dark = looks_dark(image);
  facts["dark"] = dark ? 1.0 : 0.0;
  facts["blobs"] = facts["blob_cover"] = 0.0;
  const BlobField field = blob_field(image, dark);
  const std::optional<double> radius = estimate_radius(field, {});
  if (!radius) return;
  const std::vector<BlobSeed> blobs = find_blobs(field, *radius);
  facts["blobs"] = static_cast<double>(blobs.size());
  const ImageGrid& grid = field.v.grid;
  Image<std::uint8_t> near(grid);
  const double reach = 1.3 * *radius;
  for (const BlobSeed& blob : blobs) {
    const IndexBox box =
        box_around(grid, blob.position - Vec3::Constant(reach), blob.position + Vec3::Constant(reach), 0.0);
    for (int k = box.begin[2]; k < box.begin[2] + box.size[2]; ++k) {
      for (int j = box.begin[1]; j < box.begin[1] + box.size[1]; ++j) {
        for (int i = box.begin[0]; i < box.begin[0] + box.size[0]; ++i) {
          if ((grid.world_from_index(Vec3(i, j, k)) - blob.position).norm() <= reach) near.at(i, j, k) = 1;
        }
      }
    }
  }
  // Smoothed below the size of a blob: else the threshold would split the noise of a large background.
  const Image<float> smooth = gaussian_smooth(field.v, 0.35 * *radius);
  const double threshold = threshold_of_two_classes(smooth.voxels);
  double covered = 0.0, foreground = 0.0;
  for (std::size_t n = 0; n < near.voxels.size(); ++n) {
    if (static_cast<double>(smooth.voxels[n]) <= threshold) continue;
    foreground += 1.0;
    covered += near.voxels[n];
  }
  if (foreground > 0.0) facts["blob_cover"] = covered / foreground;
}

}  // namespace

Facts image_facts(const Image<float>& image, std::size_t seeded, bool spacing_known) {
  Facts facts;
  const Vec3 field = image.grid.extent();
  facts["field_min_mm"] = field.minCoeff();
  facts["field_max_mm"] = field.maxCoeff();
  facts["voxel_mm"] = image.grid.mean_spacing();
  facts["spacing_known"] = spacing_known ? 1.0 : 0.0;
  facts["seeds"] = static_cast<double>(seeded);
  const auto voxels = static_cast<double>(image.voxels.size());
  const double spacing = image.grid.mean_spacing() * std::cbrt(std::max(1.0, voxels / kFactVoxels));
  const Image<float> coarse = crop_and_bin(image, {{0, 0, 0}, image.grid.size}, bin_factors(image.grid, spacing));
  add_intensity_facts(coarse, facts);
  const auto [low, high] = std::minmax_element(coarse.voxels.begin(), coarse.voxels.end());
  if (*high > *low) {
    add_blob_facts(coarse, facts);
  } else {
    facts["dark"] = facts["blobs"] = facts["blob_cover"] = 0.0;
  }
  return facts;
}

}  // namespace pellicle
