#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "pellicle/pipeline/evaluate.h"

namespace pellicle {
using json = nlohmann::ordered_json;

namespace {

json number(std::optional<double> value) {
  return value && std::isfinite(*value) ? json(*value) : json(nullptr);
}

std::optional<double> distance(const Agreement& a, double SurfaceDistances::*which) {
  if (!a.distances) return std::nullopt;
  return (*a.distances).*which;
}

void add_agreement(const Agreement& a, json& out) {
  out["dice"] = a.dice;
  out["iou"] = a.iou;
  out["volume_error"] = number(a.volume_error);
  out["truth_volume_ml"] = a.truth_volume_ml;
  out["result_volume_ml"] = a.result_volume_ml;
  out["hd_mm"] = number(distance(a, &SurfaceDistances::hd));
  out["hd95_mm"] = number(distance(a, &SurfaceDistances::hd95));
  out["assd_mm"] = number(distance(a, &SurfaceDistances::assd));
  out["nsd"] = number(distance(a, &SurfaceDistances::nsd));
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
