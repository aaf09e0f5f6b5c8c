#include "command_flags.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <iostream>

#include "flag_text.h"
#include "pellicle/base/errors.h"
#include "pellicle/settings/setting_words.h"
#include "pellicle/settings/toml_settings.h"

namespace pellicle::cli {

namespace {

// "bids-dir" -> "BIDS_DIR".
std::string argument_name(const std::string& key) {
  std::string name = key;
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::toupper(c); });
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

bool may_repeat(const SettingKey& key) {
  return key.kind == SettingKind::vectors || key.kind == SettingKind::table || key.kind == SettingKind::several ||
         key.kind == SettingKind::flag;
}

bool is_comma_list(const SettingKey& key) {
  return key.kind == SettingKind::words || key.kind == SettingKind::vector;
}

void declare_flag(CLI::App& app, const SettingEntry& entry, std::vector<std::string>& words) {
  const SettingKey& key = *entry.key;
  const std::string standard = key.standard.empty() ? joined_by_commas(entry.values) : key.standard;
  const std::string help = with_flags(key.help);
  const std::string flag = fmt::format("{}{}--{}", key.short_flag, key.short_flag.empty() ? "" : ",", key.name);
  CLI::Option* option = nullptr;
  if (key.kind == SettingKind::flag) {
    const bool on = standard == "true";
    option = app.add_flag(flag, words, help + (on ? fmt::format("; on unless --{}=false", key.name) : ""));
  } else {
    option = app.add_option(key.argument ? argument_name(key.name) : flag, words, help);
    if (!(key.argument && key.placeholder.empty())) option->type_name(key.placeholder);
    if (!standard.empty()) option->default_str(standard);
    // One word at a time, so that the next one is left to an argument; each time the flag is given adds one.
    if (key.kind != SettingKind::several) option->expected(1)->allow_extra_args(false);
    option->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  }
  if (!key.argument) option->group(key.group);
  if (key.required) option->required();
}

}  // namespace

void TypedSettings::declare(CLI::App& app, const std::vector<SettingEntry>& defaults) {
  for (const SettingEntry& entry : defaults) {
    typed_.push_back({entry.key, {}});
    declare_flag(app, entry, typed_.back().words);
  }
}

const std::vector<std::string>& TypedSettings::words(const std::string& key) const {
  static const std::vector<std::string> none;
  const auto found = std::find_if(typed_.begin(), typed_.end(), [&](const Typed& t) { return t.key->name == key; });
  return found == typed_.end() ? none : found->words;
}

std::vector<SettingEntry> TypedSettings::entries() const {
  std::vector<SettingEntry> entries;
  for (const auto& [key, words] : typed_) {
    if (words.empty()) continue;
    const bool choice = !key->choices().empty() || key->name == "preset";
    if (choice && words.size() == 1 && words.front() == unset_) continue;
    if (words.size() > 1 && !may_repeat(*key)) {
      throw SettingError("flag given twice", key->name, "it takes one value; keep one");
    }
    if (key->kind == SettingKind::flag) {
      entries.push_back({key, {words.back()}});
    } else {
      entries.push_back({key, is_comma_list(*key) ? split_commas(words.front()) : words});
    }
  }
  return entries;
}

void TypedSettings::apply(const std::vector<SettingTarget>& targets) const {
  const auto typed = entries();
  for (const SettingTarget& target : targets) {
    const auto entry = std::find_if(typed.begin(), typed.end(),
                                    [&](const SettingEntry& one) { return one.key->name == target.key->name; });
    if (entry != typed.end()) target.set(entry->values);
  }
}

CommandFlags::CommandFlags(CLI::App& app, const std::vector<SettingEntry>& defaults) : command_(app.get_name()) {
  typed_.declare(app, joined(defaults, entries_of(dry_run_table(), HostSettings{})));
  // What a file may hold, or a dry run needs not, cannot be required of the command line.
  const auto nothing_required = [&app](const auto&) {
    for (CLI::Option* option : app.get_options()) option->required(false);
  };
  app.get_option("--dry-run")->each(nothing_required);
  app.add_option("--config", config_, "settings file: any flag as a key; the command line wins")
      ->type_name("FILE.toml")
      ->group("Run")
      ->each(nothing_required);
}

void CommandFlags::resolve(const std::vector<SettingTarget>& settings, Console& console) {
  const auto targets = joined(settings, targets_of(dry_run_table(), host_));
  if (!config_.empty()) apply_toml_file(config_, command_, targets);
  typed_.apply(targets);
  console.configure(host_.console);
}

bool CommandFlags::only_prints(const std::vector<SettingEntry>& settings) const {
  if (host_.dry_run) {
    std::cout << toml_of(joined(settings, entries_of(dry_run_table(), host_)));
    return true;
  }
  for (const SettingEntry& entry : settings) {
    if (!entry.key->required || !entry.values.empty()) continue;
    const std::string key = entry.key->argument ? argument_name(entry.key->name) : entry.key->name;
    throw SettingError("missing setting", key, fmt::format("give it a value: {}", entry.key->placeholder));
  }
  return false;
}

}  // namespace pellicle::cli
