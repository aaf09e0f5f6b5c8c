#pragma once
/// Flags of a command, made from its table of settings: what they are called, what was typed after them, and what
/// follows from it together with a settings file.

#include <functional>
#include <list>
#include <memory>
#include <string>
#include <vector>

#include "console.h"
#include "pellicle/settings/setting_table.h"

namespace CLI {
class App;
}

namespace pellicle::cli {

/// Returns the exit code; throws pellicle::Error.
using Run = std::function<int(Console&)>;

/// What was typed after each flag of a table. CLI11 writes to it, so it must live as long as the app.
class TypedSettings {
 public:
  /// \param unset of a setting with choices: the word that says that nothing was chosen; empty: there is none.
  explicit TypedSettings(std::string unset = {}) : unset_(std::move(unset)) {}
  TypedSettings(const TypedSettings&) = delete;
  TypedSettings& operator=(const TypedSettings&) = delete;

  /// Declares a flag, or an argument, for each setting. \param defaults the values of default settings, for the help.
  void declare(CLI::App& app, const std::vector<SettingEntry>& defaults);

  /// Sets what was typed. \throws SettingError.
  void apply(const std::vector<SettingTarget>& targets) const;

  /// The words after one flag; empty: it was not typed.
  const std::vector<std::string>& words(const std::string& key) const;
  /// What was typed, in the order of the tables. \throws SettingError when a flag was given twice.
  std::vector<SettingEntry> entries() const;

 private:
  struct Typed {
    const SettingKey* key;
    std::vector<std::string> words;
  };
  std::string unset_;
  std::list<Typed> typed_;  // a list: its elements stay where they are
};

/// Settings of the program around a job: its logs, its progress, and whether the job runs at all.
struct HostSettings {
  ConsoleOptions console;
  bool dry_run = false;
  bool progress_xml = false;
};
/// Rows of every command: quiet, verbose, log-json, no-progress.
const SettingTable<HostSettings>& console_table();
/// The same and dry-run.
const SettingTable<HostSettings>& dry_run_table();

/// The same and progress-xml; of a segmentation.
const SettingTable<HostSettings>& segment_host_table();

/// The flags of a command that has nothing but a table: --config and --dry-run come with them.
class CommandFlags {
 public:
  /// \param defaults the values of default settings.
  CommandFlags(CLI::App& app, const std::vector<SettingEntry>& defaults);

  /// Defaults, then the file of --config, then the command line; sets up the console.
  /// \throws SettingError
  /// \throws NoInput
  /// \throws BadData
  void resolve(const std::vector<SettingTarget>& settings, Console& console);
  /// Whether the command only prints its settings; it has done so then.
  /// \throws SettingError when a required setting is missing and the command is to run.
  bool only_prints(const std::vector<SettingEntry>& settings) const;

 private:
  std::string command_;
  TypedSettings typed_;
  HostSettings host_;
  std::string config_;
};

/// Declares the flags of `table`; what is returned resolves them, checks them and runs the command.
template <class S>
Run settings_command(CLI::App& app, const SettingTable<S>& table, std::function<int(const S&, Console&)> run) {
  auto flags = std::make_shared<CommandFlags>(app, entries_of(table, S{}));
  return [flags, run = std::move(run), &table](Console& console) {
    S settings;
    flags->resolve(targets_of(table, settings), console);
    settings.validate();
    return flags->only_prints(entries_of(table, settings)) ? 0 : run(settings, console);
  };
}

}  // namespace pellicle::cli
