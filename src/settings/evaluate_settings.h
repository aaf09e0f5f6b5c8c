#pragma once
/// Settings of `pellicle evaluate`: a result against the truth.

#include <filesystem>

#include "pellicle/settings/setting_table.h"

namespace pellicle {

struct EvaluateSettings {
  std::filesystem::path truth, result;  ///< mask, label map, mesh, model or phantom JSON
  double tolerance_mm = 1.0;            ///< of the normalised surface Dice
  bool multi = false;                   ///< also for each label
  std::filesystem::path json;           ///< the figures as JSON; empty: not written
  bool overwrite = false;
  int threads = 0;  ///< 0: all

  /// \throws SettingError with the key, its value and the rule. Does not look at any file.
  void validate() const;
};

const SettingTable<EvaluateSettings>& evaluate_table();

}  // namespace pellicle
