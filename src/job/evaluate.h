#pragma once
/// Truth against result: overlap and surface distances, for masks, label maps and meshes.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pellicle/image/image.h"
#include "pellicle/mesh/distance.h"
#include "pellicle/mesh/triangle_mesh.h"

namespace pellicle {

/// What is known of an object: voxels, a surface, or (of a phantom) both and the exact volume.
struct EvaluationInput {
  std::string name;  ///< in messages and results
  std::string kind;  ///< "label map", "mesh", "model", "phantom"
  std::optional<Image<std::int32_t>> labels;
  std::optional<TriangleMesh> mesh;
  std::optional<double> exact_volume_ml;
};

/// Rule for empty masks: both empty: dice and iou 1, volume error 0; one empty: dice and iou 0, no volume error against
/// an empty truth. Distances do not exist when either is empty.
struct Agreement {
  double dice = 0.0, iou = 0.0;
  std::optional<double> volume_error;  ///< (result - truth) / truth
  double truth_volume_ml = 0.0, result_volume_ml = 0.0;
  std::optional<SurfaceDistances> distances;  ///< mm
};

struct LabelAgreement {
  int label = 0;  ///< the same in both
  Agreement agreement;
  int best_match = 0;  ///< result label that overlaps this truth label most; 0: none
  double best_iou = 0.0;
};

/// Objects found: pairs of any labels whose IoU is at least one half, best first, each label once.
struct Detection {
  int true_positives = 0, false_positives = 0, false_negatives = 0;
  double precision = 0.0, recall = 0.0, f1 = 0.0;  ///< 1 when there is nothing to find and nothing was found
};

struct Evaluation {
  std::string truth, result;
  double tolerance_mm = 1.0;
  Agreement whole;                     ///< everything that is not 0 against everything that is not 0
  std::vector<LabelAgreement> labels;  ///< with multi only
  std::optional<Detection> detection;  ///< with multi only
};

/// \param multi also per label; both sides must have voxels, or one object each.
/// \throws BadData when two label maps lie on different grids, or a mesh is open.
Evaluation evaluate_result(const EvaluationInput& truth, const EvaluationInput& result, double tolerance_mm,
                           bool multi);

}  // namespace pellicle
