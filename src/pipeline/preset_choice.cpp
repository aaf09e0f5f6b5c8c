#include "pellicle/pipeline/preset_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pellicle/base/errors.h"
#include "pellicle/pipeline/seeding.h"
#include "pellicle/settings/settings_toml.h"

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

std::size_t seeded_objects(const SegmentSettings& settings) {
  std::size_t count = settings.all_seed_spheres().size();
  if (settings.seeds_file) count += read_seed_table(*settings.seeds_file).size();
  if (settings.seed_mask || settings.seed_model || settings.points) count = std::max<std::size_t>(1, count);
  return count;
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

PresetChoice choose_preset_for(const SegmentSettings& typed) {
  if (typed.input.empty()) {
    throw SettingError("missing setting", "input", "`preset` auto looks at the input volume; give `input` VOLUME");
  }
  check_seed_files(typed);
  const Volume volume = read_volume(typed.input, {typed.spacing, 0});
  return choose_preset(list_presets(), image_facts(volume.image, seeded_objects(typed), volume.header.spacing_known));
}

}  // namespace pellicle
