#include "pellicle/output/evaluation_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "pellicle/base/errors.h"
#include "pellicle/image/files/volume_file.h"
#include "pellicle/mesh/files/mesh_file.h"
#include "pellicle/output/report_json.h"
#include "pellicle/surface/model_file.h"

namespace pellicle {
namespace fs = std::filesystem;
using json = nlohmann::ordered_json;

namespace {

EvaluationInput read_json_evidence(const fs::path& path) {
  std::ifstream in(path);
  const auto content = nlohmann::json::parse(in, nullptr, false);
  if (content.is_discarded() || !content.is_object()) {
    throw BadData(
        fmt::format("not JSON ({}): the file is neither a model nor a phantom's truth; check the path", path.string()));
  }
  EvaluationInput evidence{path.string(), "", {}, {}, {}};
  if (content.value("kind", "") == "pellicle phantom truth") {
    fs::path beside = path;
    evidence.kind = "phantom";
    evidence.labels = read_labels(beside.replace_extension(".nii.gz")).labels;
    // Objects of a cluster may overlap: the labels say what is whose, the volumes of the whole are counted.
    if (content.contains("shape") && content["shape"] == "cluster") return evidence;
    evidence.mesh = read_mesh(beside.replace_extension("").replace_extension(".ply"));
    if (!content.contains("exact_volume_ml") || !content["exact_volume_ml"].is_number()) {
      throw BadData(
          fmt::format("broken phantom ({}): exact_volume_ml is missing; write the phantom again", path.string()));
    }
    evidence.exact_volume_ml = content["exact_volume_ml"].get<double>();
  } else {
    evidence.kind = "model";
    const Surface surface = read_model(path);
    evidence.mesh = tessellate(surface, std::min(6, tessellation_level(surface, 0.5)));
  }
  return evidence;
}

std::optional<double> distance(const Agreement& a, double SurfaceDistances::*which) {
  if (!a.distances) return std::nullopt;
  return (*a.distances).*which;
}

void add_agreement(const Agreement& a, json& out) {
  out["dice"] = a.dice;
  out["iou"] = a.iou;
  out["volume_error"] = number_json(a.volume_error);
  out["truth_volume_ml"] = a.truth_volume_ml;
  out["result_volume_ml"] = a.result_volume_ml;
  out["hd_mm"] = number_json(distance(a, &SurfaceDistances::hd));
  out["hd95_mm"] = number_json(distance(a, &SurfaceDistances::hd95));
  out["assd_mm"] = number_json(distance(a, &SurfaceDistances::assd));
  out["nsd"] = number_json(distance(a, &SurfaceDistances::nsd));
}

std::string cell(std::optional<double> value, const char* pattern) {
  return value ? fmt::format(fmt::runtime(pattern), *value) : "-";
}

std::string row_of(const std::string& label, const Agreement& a) {
  return fmt::format(
      "{:<8}{:>8.4f}{:>8.4f}{:>10}{:>12.5g}{:>12.5g}{:>9}{:>9}{:>9}{:>8}\n", label, a.dice, a.iou,
      cell(a.volume_error, "{:+.4f}"), a.truth_volume_ml, a.result_volume_ml,
      cell(distance(a, &SurfaceDistances::hd), "{:.3f}"), cell(distance(a, &SurfaceDistances::hd95), "{:.3f}"),
      cell(distance(a, &SurfaceDistances::assd), "{:.3f}"), cell(distance(a, &SurfaceDistances::nsd), "{:.4f}"));
}

}  // namespace

EvaluationInput read_evaluation_input(const fs::path& path) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) {
    throw NoInput(fmt::format("no such file ({}): nothing is there; check the path", path.string()));
  }
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  static const std::set<std::string> meshes{".ply", ".stl", ".obj", ".off", ".vtp", ".gii"};
  if (extension == ".json") return read_json_evidence(path);
  if (meshes.count(extension) != 0) return {path.string(), "mesh", {}, read_mesh(path), {}};
  return {path.string(), "label map", read_labels(path).labels, {}, {}};
}

json json_of(const Evaluation& evaluation) {
  json out;
  out["truth"] = evaluation.truth;
  out["result"] = evaluation.result;
  out["tolerance_mm"] = evaluation.tolerance_mm;
  add_agreement(evaluation.whole, out);
  if (!evaluation.detection) return out;
  out["labels"] = json::array();
  for (const auto& row : evaluation.labels) {
    json label;
    label["label"] = row.label;
    add_agreement(row.agreement, label);
    label["best_match"] = row.best_match == 0 ? json(nullptr) : json(row.best_match);
    label["best_iou"] = row.best_iou;
    out["labels"].push_back(label);
  }
  const Detection& d = *evaluation.detection;
  out["f1"] = d.f1;
  out["precision"] = d.precision;
  out["recall"] = d.recall;
  out["true_positives"] = d.true_positives;
  out["false_positives"] = d.false_positives;
  out["false_negatives"] = d.false_negatives;
  return out;
}

std::string table_of(const Evaluation& evaluation) {
  std::string text = fmt::format("{:<8}{:>8}{:>8}{:>10}{:>12}{:>12}{:>9}{:>9}{:>9}{:>8}\n", "label", "dice", "iou",
                                 "vol_err", "truth_ml", "result_ml", "hd_mm", "hd95_mm", "assd_mm",
                                 fmt::format("nsd@{:g}", evaluation.tolerance_mm));
  text += row_of("all", evaluation.whole);
  for (const auto& row : evaluation.labels) text += row_of(fmt::format("{}", row.label), row.agreement);
  if (evaluation.detection) {
    const Detection& d = *evaluation.detection;
    text += fmt::format("f1 {:.4f} at IoU 0.5 (precision {:.4f}, recall {:.4f}; {} found, {} missed, {} false)\n", d.f1,
                        d.precision, d.recall, d.true_positives, d.false_negatives, d.false_positives);
  }
  return text;
}

}  // namespace pellicle
