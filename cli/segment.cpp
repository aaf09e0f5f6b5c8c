#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "commands.h"
#include "pellicle/base/errors.h"
#include "pellicle/energies/energy_kinds.h"
#include "pellicle/fit/many.h"
#include "pellicle/pipeline/boutiques_description.h"
#include "pellicle/pipeline/preset_choice.h"
#include "pellicle/pipeline/seed_preview.h"
#include "pellicle/pipeline/segment.h"
#include "pellicle/pipeline/segment_series.h"
#include "pellicle/pipeline/slicer_description.h"
#include "pellicle/settings/settings_toml.h"
#include "slicer_progress.h"

namespace pellicle::cli {

namespace {

std::string joined(const SettingValues& values) {
  std::string text;
  for (const auto& value : values) text += (text.empty() ? "" : ",") + value;
  return text;
}

}  // namespace

void add_setting_flag(CLI::App& app, const SettingKey& key, std::vector<std::string>& values) {
  const std::string flags = fmt::format("{}{}--{}", key.short_flag, key.short_flag.empty() ? "" : ",", key.name);
  const std::string standard = joined(key.get(SegmentSettings{}));
  CLI::Option* option = nullptr;
  if (key.kind == SettingKind::flag) {
    const bool on = standard == "true";
    option = app.add_flag(flags, values, key.help + (on ? fmt::format("; on unless --{}=false", key.name) : ""));
  } else {
    option = app.add_option(flags, values, key.help)->type_name(key.placeholder)->expected(1);
    if (!standard.empty()) option->default_str(standard);
    option->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  }
  option->group(key.group);
}

namespace {

/// Words that followed each flag on the command line.
struct Typed {
  std::vector<std::vector<std::string>> values;
  std::string config;
  std::string address, return_file;  ///< from hosts like 3D Slicer; nothing is made of them
  bool slicer = false, boutiques = false;
};

bool may_repeat(const SettingKey& key) {
  return key.kind == SettingKind::vectors || key.kind == SettingKind::table;
}

void apply_typed(const SettingKey& key, const std::vector<std::string>& values, SegmentSettings& settings) {
  if (values.empty()) return;
  // A choice that hosts hand over though nobody made it: the preset decides.
  const bool choice = !key.choices().empty() || key.name == "preset";
  if (choice && values.size() == 1 && values.front() == "default") return;
  const std::string flag = fmt::format("--{}", key.name);
  if (values.size() > 1 && !may_repeat(key) && key.kind != SettingKind::flag) {
    throw UsageError(fmt::format("flag given twice ({}): it takes one value; keep one", flag));
  }
  const std::string where = key.kind == SettingKind::flag ? flag : fmt::format("{} {}", flag, values.back());
  if (key.kind == SettingKind::flag) {
    key.set(settings, {values.back()}, where);
  } else if (key.kind == SettingKind::words || key.kind == SettingKind::vector) {
    key.set(settings, split_commas(values.front()), where);
  } else {
    key.set(settings, values, where);
  }
}

// Defaults, then the preset, then the file of --config, then the command line.
SegmentSettings resolve(const Typed& typed, std::optional<PresetChoice>& choice) {
  const auto& keys = segment_keys();
  SegmentSettings settings, commanded;
  for (std::size_t i = 0; i < keys.size(); ++i) apply_typed(keys[i], typed.values[i], commanded);
  std::string preset = commanded.preset;
  if (preset.empty() && !typed.config.empty()) preset = read_toml_notes(typed.config).preset;
  if (preset == "auto") {
    SegmentSettings known;
    if (!typed.config.empty()) apply_toml_file(typed.config, known);
    for (std::size_t i = 0; i < keys.size(); ++i) apply_typed(keys[i], typed.values[i], known);
    choice = choose_preset_for(known);
    preset = choice->name;
  }
  if (!preset.empty()) {
    apply_toml_file(find_preset(preset), settings);
    if (!settings.preset.empty()) {
      throw UsageError(
          fmt::format("bad preset (--preset {}): a preset cannot name another; remove its key 'preset'", preset));
    }
  }
  if (!typed.config.empty()) apply_toml_file(typed.config, settings);
  for (std::size_t i = 0; i < keys.size(); ++i) apply_typed(keys[i], typed.values[i], settings);
  settings.preset = preset;
  return settings;
}

bool asks_for_list(const Typed& typed, const std::string& name) {
  const auto& keys = segment_keys();
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (keys[i].name != name) continue;
    for (const auto& value : typed.values[i]) {
      if (value == "list") return true;
    }
  }
  return false;
}

void print_presets() {
  for (const auto& preset : list_presets()) {
    std::cout << fmt::format("{:<12} {}\n{:<12} {}\n", preset.name, preset.description, "", preset.path.string());
  }
}

void print_energies() {
  for (const EnergyKind& energy : energy_kinds()) {
    std::cout << fmt::format("{:<12} {:<9} {}\n{:<12} {:<9} {}\n", energy.name, energy.kind, energy.formula, "", "",
                             energy.text);
  }
}

// The stages that follow from the settings stand there as comments: as a starting point for one's own.
void print_dry_run(const SegmentSettings& settings) {
  std::cout << toml_of(settings);
  if (!settings.fit.stages.empty()) return;
  std::cout << "\n# These stages follow from the settings above; to change them, remove the '# ' in front.\n";
  std::istringstream lines(
      toml_of_stages(settings.wants_many() ? stages_of_many(settings.fit) : stages_of(settings.fit)));
  for (std::string line; std::getline(lines, line);) std::cout << fmt::format("# {}", line) << "\n";
}

// Comments again, so that all of it is still a settings file.
void print_preview(const SegmentSettings& settings, Console& console) {
  RunContext context;
  context.warn = [&](const std::string& message) { console.warn(message); };
  const SeedPreview preview = preview_seeds(settings, context);
  std::cout << "\n# What a run would do; the seeds are drawn in " << preview.picture.string() << "\n";
  for (const std::string& line : preview.lines) std::cout << "# " << line << "\n";
}

// A line an object and frame, in the order of the frames.
int run_series(const SegmentSettings& settings, const RunContext& context, Console& console) {
  const SeriesResult series = segment_series(settings, context);
  for (const SeriesRow& row : series.rows) {
    std::cout << fmt::format("{} {:.6g} {} {:.3f}\n", row.label, row.volume_ml, to_string(row.status), row.seconds);
    if (row.status != FitStatus::ok) {
      console.warn(fmt::format("{} ({}, frame {}): {}", to_string(row.status), row.name, row.frame, row.reason));
    }
  }
  return series.exit_code;
}

int run_segment(const Typed& typed, const std::vector<std::string>& command_line, Console& console) {
  if (typed.slicer || typed.boutiques) {
    std::cout << (typed.slicer ? slicer_description() : boutiques_description().dump(2) + "\n");
    return 0;
  }
  if (asks_for_list(typed, "preset")) {
    print_presets();
    return 0;
  }
  if (asks_for_list(typed, "energy")) {
    print_energies();
    return 0;
  }
  std::optional<PresetChoice> choice;
  const SegmentSettings settings = resolve(typed, choice);
  console.configure({settings.quiet, settings.verbose, settings.log_json, settings.no_progress});
  if (choice) {
    console.notice(fmt::format("--preset auto: {}, because {}",
                               choice->name.empty() ? "no preset, the defaults" : choice->name, choice->reason));
  }
  if (settings.dry_run) {
    settings.validate_values();
    print_dry_run(settings);
    if (!settings.input.empty() && !settings.output.empty()) print_preview(settings, console);
    return 0;
  }
  SlicerProgress slicer(settings.progress_xml);
  RunContext context{command_line,
                     [&](double share, const std::string& what) {
                       console.progress(share, what);
                       slicer.tell(share, what);
                     },
                     [&](const std::string& message) { console.inform(message); },
                     [&](const std::string& message) { console.warn(message); }};
  context.chosen_preset = choice;
  settings.validate();
  if (frames_of(settings) > 1) return run_series(settings, context, console);
  const SegmentResult result = segment(settings, context);
  for (const auto& object : result.objects) {
    std::cout << fmt::format("{} {:.6g} {} {:.3f}\n", object.label, object.volume_surface_ml,
                             to_string(object.fit.status), object.seconds);
    if (object.fit.status != FitStatus::ok) {
      console.warn(fmt::format("{} ({}): {}", to_string(object.fit.status), object.name, object.fit.reason));
    }
  }
  return result.exit_code();
}

}  // namespace

Run add_segment(CLI::App& app, const std::vector<std::string>& command_line) {
  auto typed = std::make_shared<Typed>();
  const auto& keys = segment_keys();
  typed->values.resize(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i) add_setting_flag(app, keys[i], typed->values[i]);
  app.add_option("--config", typed->config, "settings file: any flag as a key; the command line wins")
      ->type_name("FILE.toml")
      ->group("Run");
  app.add_flag("--xml", typed->slicer, "print what 3D Slicer wants to know about this command, and stop")->group("Run");
  app.add_flag("--boutiques", typed->boutiques, "print a Boutiques descriptor of this command, and stop")->group("Run");
  app.add_option("--processinformationaddress", typed->address)->group("");
  app.add_option("--returnparameterfile", typed->return_file)->group("");
  app.footer(
      "Lengths are mm, volumes ml. One line an object on stdout: label volume_ml status seconds.\n"
      "Example: pellicle segment -i scan.nii.gz -o out --seed-sphere 12,-30,5,8 --write mask,mesh,qc");
  return [typed, command_line](Console& console) { return run_segment(*typed, command_line, console); };
}

}  // namespace pellicle::cli
