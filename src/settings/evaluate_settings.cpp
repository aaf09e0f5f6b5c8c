#include "pellicle/settings/evaluate_settings.h"

#include <cmath>

#include "pellicle/base/errors.h"
#include "pellicle/settings/setting_fields.h"

namespace pellicle {

const SettingTable<EvaluateSettings>& evaluate_table() {
  static const SettingTable<EvaluateSettings> all{
      setting<EvaluateSettings>({.group = "Input",
                                 .name = "truth",
                                 .placeholder = "FILE",
                                 .help = "mask, label map, mesh, model or phantom JSON",
                                 .argument = true,
                                 .required = true},
                                SETTING_FIELD(truth)),
      setting<EvaluateSettings>({.group = "Input",
                                 .name = "result",
                                 .placeholder = "FILE",
                                 .help = "the same kinds; they mix freely",
                                 .argument = true,
                                 .required = true},
                                SETTING_FIELD(result)),
      setting<EvaluateSettings>({"Metrics", "tolerance-mm", "T", "tolerance of the normalised surface Dice, mm"},
                                SETTING_FIELD(tolerance_mm)),
      setting<EvaluateSettings>({"Metrics", "multi", "", "also for each label, and f1 of the objects found at IoU 0.5"},
                                SETTING_FIELD(multi)),
      setting<EvaluateSettings>({"Outputs", "json", "FILE", "also write the figures to this file"},
                                SETTING_FIELD(json)),
      setting<EvaluateSettings>({"Outputs", "overwrite", "", "replace the JSON file when it exists"},
                                SETTING_FIELD(overwrite)),
      setting<EvaluateSettings>({"Run", "threads", "N", "threads; 0: all"}, SETTING_FIELD(threads))};
  return all;
}

void EvaluateSettings::validate() const {
  if (!(tolerance_mm >= 0.0) || !std::isfinite(tolerance_mm)) {
    throw SettingError("bad value", "tolerance-mm", fmt::format("{}", tolerance_mm), "must be 0 mm or more");
  }
  if (threads < 0) throw SettingError("bad value", "threads", fmt::format("{}", threads), "must be 0 (all) or more");
}

}  // namespace pellicle
