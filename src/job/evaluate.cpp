#include "pellicle/job/evaluate.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "pellicle/base/errors.h"
#include "pellicle/job/voxels.h"
#include "pellicle/mask/overlap.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/raster/rasterize.h"

namespace pellicle {

namespace {

double volume_ml(const EvaluationInput& evidence, const Image<std::uint8_t>& mask) {
  if (evidence.exact_volume_ml) return *evidence.exact_volume_ml;
  if (evidence.mesh) return volume_of(*evidence.mesh) / 1000.0;
  const auto count = std::count_if(mask.voxels.begin(), mask.voxels.end(), [](std::uint8_t v) { return v != 0; });
  return static_cast<double>(count) * mask.grid.voxel_volume() / 1000.0;
}

// The box of a mask with one voxel around: surfaces are made from it, not from the whole volume.
Image<std::uint8_t> cropped(const Image<std::uint8_t>& mask) {
  Index3 low = mask.grid.size, high{-1, -1, -1};
  const Index3 size = mask.grid.size;
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i) {
        if (mask.at(i, j, k) == 0) continue;
        const Index3 at{i, j, k};
        for (std::size_t a = 0; a < 3; ++a) {
          low[a] = std::min(low[a], at[a]);
          high[a] = std::max(high[a], at[a]);
        }
      }
    }
  }
  Box box;
  box.grid = mask.grid;
  for (std::size_t a = 0; a < 3; ++a) {
    box.first[a] = std::max(0, low[a] - 1);
    box.grid.size[a] = std::min(size[a] - 1, high[a] + 1) - box.first[a] + 1;
  }
  box.grid.origin_in_world = mask.grid.world_from_index(Vec3(box.first[0], box.first[1], box.first[2]));
  Image<std::uint8_t> part(box.grid);
  for_each_voxel(box, mask.grid,
                 [&](std::size_t outer, std::size_t inner, bool) { part.voxels[inner] = mask.voxels[outer]; });
  return part;
}

bool is_empty(const Image<std::uint8_t>& mask) {
  return std::all_of(mask.voxels.begin(), mask.voxels.end(), [](std::uint8_t v) { return v == 0; });
}

struct Side {
  Image<std::uint8_t> mask;
  const TriangleMesh* mesh = nullptr;  ///< when the surface itself is known
  double volume_ml = 0.0;
};

Agreement agreement_of(const Side& truth, const Side& result, double tolerance_mm) {
  const OverlapMetrics overlap = overlap_of(truth.mask, result.mask);
  Agreement agreement{overlap.dice, overlap.iou, overlap.volume_error, truth.volume_ml, result.volume_ml, {}};
  if (truth.volume_ml > 0.0) agreement.volume_error = (result.volume_ml - truth.volume_ml) / truth.volume_ml;
  const bool truth_empty = truth.mesh == nullptr && is_empty(truth.mask);
  const bool result_empty = result.mesh == nullptr && is_empty(result.mask);
  if (truth_empty || result_empty) return agreement;
  const auto surface = [](const Side& side) {
    return side.mesh != nullptr ? *side.mesh : surface_of_mask(cropped(side.mask));
  };
  agreement.distances = surface_distances(surface(truth), surface(result), tolerance_mm);
  return agreement;
}

ImageGrid common_grid(const TriangleMesh& a, const TriangleMesh& b) {
  if (a.vertices.empty() || b.vertices.empty()) {
    throw BadData("empty mesh (evaluate): a mesh without vertices has no overlap; check the files");
  }
  Vec3 low = a.vertices.front(), high = low;
  for (const auto* mesh : {&a, &b}) {
    for (const auto& v : mesh->vertices) {
      low = low.cwiseMin(v);
      high = high.cwiseMax(v);
    }
  }
  const double h = std::max((high - low).maxCoeff(), 1e-6) / 200.0;
  ImageGrid grid;
  grid.spacing = Vec3::Constant(h);
  grid.origin_in_world = low - Vec3::Constant(2.0 * h);
  for (int axis = 0; axis < 3; ++axis) {
    grid.size[static_cast<std::size_t>(axis)] = static_cast<int>(std::ceil((high[axis] - low[axis]) / h)) + 5;
  }
  return grid;
}

Image<std::uint8_t> nonzero(const Image<std::int32_t>& labels) {
  Image<std::uint8_t> mask(labels.grid);
  std::transform(labels.voxels.begin(), labels.voxels.end(), mask.voxels.begin(),
                 [](std::int32_t v) { return static_cast<std::uint8_t>(v != 0 ? 1 : 0); });
  return mask;
}

std::string describe(const ImageGrid& grid) {
  return fmt::format("{}x{}x{} voxels of {:.4g}x{:.4g}x{:.4g} mm", grid.size[0], grid.size[1], grid.size[2],
                     grid.spacing[0], grid.spacing[1], grid.spacing[2]);
}

// Both as masks on one grid.
std::pair<Image<std::uint8_t>, Image<std::uint8_t>> masks_of(const EvaluationInput& truth,
                                                             const EvaluationInput& result) {
  const bool both = truth.labels && result.labels;
  if (both && same_grid(truth.labels->grid, result.labels->grid)) {
    return {nonzero(*truth.labels), nonzero(*result.labels)};
  }
  if (result.labels && truth.mesh) {
    const auto& grid = result.labels->grid;
    return {rasterize_mask(*truth.mesh, grid), nonzero(*result.labels)};
  }
  if (truth.labels && result.mesh) {
    const auto& grid = truth.labels->grid;
    return {nonzero(*truth.labels), rasterize_mask(*result.mesh, grid)};
  }
  if (both) {
    throw BadData(
        fmt::format("grids differ ({} against {}): {} against {}, or another place; resample one onto the other",
                    truth.name, result.name, describe(truth.labels->grid), describe(result.labels->grid)));
  }
  const ImageGrid grid = common_grid(*truth.mesh, *result.mesh);
  return {rasterize_mask(*truth.mesh, grid), rasterize_mask(*result.mesh, grid)};
}

// Voxel counts of all labels and of all pairs of labels.
struct PairCounts {
  std::map<int, std::size_t> truth, result;
  std::map<std::pair<int, int>, std::size_t> both;
  double iou(int t, int r) const {
    const auto pair = both.find({t, r});
    if (pair == both.end()) return 0.0;
    const auto common = static_cast<double>(pair->second);
    return common / (static_cast<double>(truth.at(t) + result.at(r)) - common);
  }
};

PairCounts count_pairs(const Image<std::int32_t>& truth, const Image<std::int32_t>& result) {
  PairCounts counts;
  for (std::size_t i = 0; i < truth.voxels.size(); ++i) {
    const int t = truth.voxels[i], r = result.voxels[i];
    if (t != 0) ++counts.truth[t];
    if (r != 0) ++counts.result[r];
    if (t != 0 && r != 0) ++counts.both[{t, r}];
  }
  return counts;
}

Detection detection_of(const PairCounts& counts) {
  std::vector<std::tuple<double, int, int>> pairs;
  for (const auto& [pair, common] : counts.both) {
    const double iou = counts.iou(pair.first, pair.second);
    if (iou >= 0.5) pairs.emplace_back(-iou, pair.first, pair.second);
  }
  std::sort(pairs.begin(), pairs.end());
  std::set<int> truth_used, result_used;
  for (const auto& [negative_iou, t, r] : pairs) {
    if (truth_used.count(t) == 0 && result_used.count(r) == 0) {
      truth_used.insert(t);
      result_used.insert(r);
    }
  }
  Detection d;
  d.true_positives = static_cast<int>(truth_used.size());
  d.false_negatives = static_cast<int>(counts.truth.size()) - d.true_positives;
  d.false_positives = static_cast<int>(counts.result.size()) - d.true_positives;
  const auto fraction = [](int part, int rest) {
    return part + rest == 0 ? 1.0 : static_cast<double>(part) / (part + rest);
  };
  d.precision = fraction(d.true_positives, d.false_positives);
  d.recall = fraction(d.true_positives, d.false_negatives);
  d.f1 = fraction(2 * d.true_positives, d.false_positives + d.false_negatives);
  return d;
}

void evaluate_labels(const Image<std::int32_t>& truth, const Image<std::int32_t>& result, Evaluation& evaluation) {
  const PairCounts counts = count_pairs(truth, result);
  std::set<int> labels;
  for (const auto& [label, count] : counts.truth) labels.insert(label);
  for (const auto& [label, count] : counts.result) labels.insert(label);
  const auto side = [](const Image<std::int32_t>& image, int label) {
    Side out{Image<std::uint8_t>(image.grid), nullptr, 0.0};
    std::size_t count = 0;
    for (std::size_t i = 0; i < image.voxels.size(); ++i) {
      if (image.voxels[i] != label) continue;
      out.mask.voxels[i] = 1;
      ++count;
    }
    out.volume_ml = static_cast<double>(count) * image.grid.voxel_volume() / 1000.0;
    return out;
  };
  for (const int label : labels) {
    LabelAgreement row{label, agreement_of(side(truth, label), side(result, label), evaluation.tolerance_mm), 0, 0.0};
    for (const auto& [other, count] : counts.result) {
      const double iou = counts.truth.count(label) != 0 ? counts.iou(label, other) : 0.0;
      if (iou > row.best_iou) {
        row.best_iou = iou;
        row.best_match = other;
      }
    }
    evaluation.labels.push_back(row);
  }
  evaluation.detection = detection_of(counts);
}

Image<std::int32_t> labels_on(const EvaluationInput& evidence, const Image<std::uint8_t>& mask) {
  if (evidence.labels && same_grid(evidence.labels->grid, mask.grid)) return *evidence.labels;
  Image<std::int32_t> labels(mask.grid);
  std::copy(mask.voxels.begin(), mask.voxels.end(), labels.voxels.begin());
  return labels;
}

}  // namespace

Evaluation evaluate_result(const EvaluationInput& truth, const EvaluationInput& result, double tolerance_mm,
                           bool multi) {
  Evaluation evaluation{truth.name, result.name, tolerance_mm, {}, {}, {}};
  auto [truth_mask, result_mask] = masks_of(truth, result);
  if (multi) evaluate_labels(labels_on(truth, truth_mask), labels_on(result, result_mask), evaluation);
  const double truth_ml = volume_ml(truth, truth_mask), result_ml = volume_ml(result, result_mask);
  const Side truth_side{std::move(truth_mask), truth.mesh ? &*truth.mesh : nullptr, truth_ml};
  const Side result_side{std::move(result_mask), result.mesh ? &*result.mesh : nullptr, result_ml};
  evaluation.whole = agreement_of(truth_side, result_side, tolerance_mm);
  return evaluation;
}

}  // namespace pellicle
