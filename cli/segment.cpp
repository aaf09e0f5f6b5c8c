#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "command_flags.h"
#include "commands.h"
#include "flag_text.h"
#include "hosts/boutiques_description.h"
#include "hosts/slicer_description.h"
#include "hosts/slicer_progress.h"
#include "pellicle/base/errors.h"
#include "pellicle/energies/energy_kinds.h"
#include "pellicle/fit/many/many.h"
#include "pellicle/output/preset_by_image.h"
#include "pellicle/output/seed_preview.h"
#include "pellicle/output/segment_files.h"
#include "pellicle/output/series_files.h"
#include "pellicle/settings/settings_toml.h"

namespace pellicle::cli {

namespace {

/// Everything that a segmentation is started with: its settings, and those of the program around.
struct SegmentCommand {
  SegmentSettings settings;
  HostSettings host;
};

/// What was typed.
struct SegmentFlags {
  TypedSettings typed{"default"};  ///< the choice that hosts hand over when nobody made one: the preset decides
  std::string config;
  std::string address, return_file;  ///< from hosts like 3D Slicer; they are not used
  bool slicer = false, boutiques = false;
};

void apply_file(const std::filesystem::path& path, SegmentCommand& command) {
  apply_toml_file(path, command.settings, targets_of(segment_host_table(), command.host));
}

void apply_typed(const SegmentFlags& flags, SegmentCommand& command) {
  flags.typed.apply(
      joined(targets_of(segment_table(), command.settings), targets_of(segment_host_table(), command.host)));
}

// Defaults, then the preset, then the file of --config, then the command line.
SegmentCommand resolve(const SegmentFlags& flags, std::optional<PresetChoice>& choice) {
  SegmentCommand command, commanded;
  apply_typed(flags, commanded);
  std::string preset = commanded.settings.preset;
  if (preset.empty() && !flags.config.empty()) preset = read_toml_notes(flags.config).preset;
  if (preset == "auto") {
    SegmentCommand known;
    if (!flags.config.empty()) apply_file(flags.config, known);
    apply_typed(flags, known);
    choice = choose_preset_for(known.settings);
    preset = choice->name;
  }
  if (!preset.empty()) {
    apply_file(find_preset(preset), command);
    if (!command.settings.preset.empty()) {
      throw SettingError("bad preset", "preset", preset, "a preset cannot name another; remove its key 'preset'");
    }
  }
  if (!flags.config.empty()) apply_file(flags.config, command);
  apply_typed(flags, command);
  command.settings.preset = preset;
  return command;
}

bool asks_for_list(const SegmentFlags& flags, const std::string& name) {
  const auto& words = flags.typed.words(name);
  return std::find(words.begin(), words.end(), "list") != words.end();
}

void print_presets() {
  for (const auto& preset : list_presets()) {
    std::cout << fmt::format("{:<12} {}\n{:<12} {}\n", preset.name, preset.description, "", preset.path.string());
  }
}

void print_energies() {
  for (const EnergyKind& energy : energy_kinds()) {
    std::cout << fmt::format("{:<12} {:<9} {}\n{:<12} {:<9} {}\n", energy.name, energy.kind, energy.formula, "", "",
                             with_flags(std::string(energy.text)));
  }
}

// The stages that follow from the settings are printed as comments: as a starting point for the user's own.
void print_dry_run(const SegmentCommand& command) {
  const SegmentSettings& settings = command.settings;
  std::cout << toml_of(settings, entries_of(segment_host_table(), command.host));
  if (!settings.fit.stages.empty()) return;
  std::cout << "\n# These stages follow from the settings above; to change them, remove the '# ' in front.\n";
  std::istringstream lines(toml_of_stages(plan_of(settings).first.stages));
  for (std::string line; std::getline(lines, line);) std::cout << fmt::format("# {}", line) << "\n";
}

// Comments again, so that all of it is still a settings file.
void print_preview(const SegmentSettings& settings, Console& console) {
  const SeedPreview preview = preview_seeds(settings, console.observer());
  std::cout << "\n# What a run would do; the seeds are drawn in " << preview.picture.string() << "\n";
  for (const std::string& line : preview.lines) std::cout << "# " << with_flags(line) << "\n";
}

// One line per object and frame, in the order of the frames.
int run_series(const SegmentSettings& settings, const RunRecord& record, const Observer& observer, Console& console) {
  const SeriesResult series = segment_series_to_files(settings, record, observer);
  for (const SeriesRow& row : series.rows) {
    std::cout << fmt::format("{} {:.6g} {} {:.3f}\n", row.label, row.volume_ml, to_string(row.status), row.seconds);
    if (row.status != FitStatus::ok) {
      console.warn(fmt::format("{} ({}, frame {}): {}", to_string(row.status), row.name, row.frame, row.reason));
    }
  }
  return series.exit_code;
}

// All settings of the command with their defaults.
std::vector<SettingEntry> all_settings() {
  return joined(entries_of(segment_table(), SegmentSettings{}), entries_of(segment_host_table(), HostSettings{}));
}

// Whether the command only describes itself; it has done so then.
bool described(const SegmentFlags& flags) {
  if (flags.slicer) {
    std::cout << slicer_description(all_settings());
  } else if (flags.boutiques) {
    std::cout << boutiques_description(all_settings()).dump(2) + "\n";
  } else if (asks_for_list(flags, "preset")) {
    print_presets();
  } else if (asks_for_list(flags, "energy")) {
    print_energies();
  } else {
    return false;
  }
  return true;
}

int run_one_volume(const SegmentSettings& settings, const RunRecord& record, const Observer& observer,
                   Console& console) {
  const SegmentResult result = segment_to_files(settings, record, observer);
  for (const auto& object : result.segmentation.objects) {
    std::cout << fmt::format("{} {:.6g} {} {:.3f}\n", object.label, object.volume_surface_ml,
                             to_string(object.fit.status), object.seconds);
    if (object.fit.status != FitStatus::ok) {
      console.warn(fmt::format("{} ({}): {}", to_string(object.fit.status), object.name, object.fit.reason));
    }
  }
  return result.exit_code();
}

int run_segment(const SegmentFlags& flags, const std::vector<std::string>& command_line, Console& console) {
  if (described(flags)) return 0;
  std::optional<PresetChoice> choice;
  const SegmentCommand command = resolve(flags, choice);
  const SegmentSettings& settings = command.settings;
  console.configure(command.host.console);
  if (choice) {
    console.notice(fmt::format("--preset auto: {}, because {}",
                               choice->name.empty() ? "no preset, the defaults" : choice->name, choice->reason));
  }
  if (command.host.dry_run) {
    settings.validate_values();
    print_dry_run(command);
    if (!settings.input.empty() && !settings.output.empty()) print_preview(settings, console);
    return 0;
  }
  SlicerProgress slicer(command.host.progress_xml);
  Observer observer = console.observer();
  observer.progress = [&](double fraction, const std::string& what) {
    console.progress(fraction, what);
    slicer.tell(fraction, what);
  };
  const RunRecord record{.command_line = command_line,
                         .chosen_preset = choice,
                         .host_settings = entries_of(segment_host_table(), command.host)};
  settings.validate();
  if (frames_of(settings) > 1) return run_series(settings, record, observer, console);
  return run_one_volume(settings, record, observer, console);
}

}  // namespace

Run add_segment(CLI::App& app, const std::vector<std::string>& command_line) {
  auto flags = std::make_shared<SegmentFlags>();
  flags->typed.declare(
      app, joined(entries_of(segment_table(), SegmentSettings{}), entries_of(segment_host_table(), HostSettings{})));
  app.add_option("--config", flags->config, "settings file: any flag as a key; the command line wins")
      ->type_name("FILE.toml")
      ->group("Run");
  app.add_flag("--xml", flags->slicer, "print the description of this command that 3D Slicer reads, and stop")
      ->group("Run");
  app.add_flag("--boutiques", flags->boutiques, "print a Boutiques descriptor of this command, and stop")->group("Run");
  app.add_option("--processinformationaddress", flags->address)->group("");
  app.add_option("--returnparameterfile", flags->return_file)->group("");
  app.footer(
      "Lengths are mm, volumes ml. One line per object on stdout: label volume_ml status seconds.\n"
      "Example: pellicle segment -i scan.nii.gz -o out --seed-sphere 12,-30,5,8 --write mask,mesh,qc");
  return [flags, command_line](Console& console) { return run_segment(*flags, command_line, console); };
}

}  // namespace pellicle::cli
