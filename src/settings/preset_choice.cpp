#include "pellicle/settings/preset_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pellicle/base/errors.h"

namespace pellicle {

namespace {

bool is_met(const PresetCondition& condition, const Facts& facts) {
  return std::all_of(condition.begin(), condition.end(), [&](const auto& one) {
    const double value = facts.at(one.first);
    return value >= one.second[0] && value <= one.second[1];
  });
}

void check_names(const Preset& preset, const PresetCondition& condition, const Facts& facts) {
  for (const auto& [name, range] : condition) {
    if (facts.contains(name)) continue;
    std::string known;
    for (const auto& [fact, value] : facts) known += (known.empty() ? "" : ", ") + fact;
    throw UsageError(fmt::format("unknown fact ({}, when.{}): known are {}", preset.path.string(), name, known));
  }
}

std::string range_text(const std::array<double, 2>& range) {
  if (std::isinf(range[1])) return fmt::format("at least {:.4g}", range[0]);
  if (range[0] == range[1]) return fmt::format("{:.4g}", range[0]);
  return fmt::format("{:.4g} to {:.4g}", range[0], range[1]);
}

std::string reason_of(const PresetCondition& condition, const Facts& facts) {
  std::string text;
  for (const auto& [name, range] : condition) {
    text +=
        fmt::format("{}{} is {:.4g} (wanted: {})", text.empty() ? "" : ", ", name, facts.at(name), range_text(range));
  }
  return text;
}

}  // namespace

PresetChoice choose_preset(const std::vector<Preset>& presets, const Facts& facts) {
  PresetChoice choice{.name = {}, .reason = "no preset's conditions are met", .facts = facts};
  std::size_t most = 0;
  for (const Preset& preset : presets) {
    for (const PresetCondition& condition : preset.when) {
      check_names(preset, condition, facts);
      if (condition.size() <= most || !is_met(condition, facts)) continue;
      most = condition.size();
      choice.name = preset.name;
      choice.reason = reason_of(condition, facts);
    }
  }
  return choice;
}

}  // namespace pellicle
