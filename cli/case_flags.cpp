#include "case_flags.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>

#include "pellicle/settings/settings.h"

namespace pellicle::cli {

void CaseFlags::declare(CLI::App& app, const std::vector<SettingEntry>& defaults, const std::string& cases) {
  own_.declare(app, defaults);
  app.add_option("--config", config_, "settings file for all " + cases)->type_name("FILE.toml")->group("Run");
  std::vector<SettingEntry> common;
  for (const SettingEntry& entry : entries_of(segment_table(), SegmentSettings{})) {
    const std::string& name = entry.key->name;
    if (may_vary(name) && name != "input" && name != "name") common.push_back(entry);
  }
  common_.declare(app, common);
  console_.declare(app, entries_of(console_table(), HostSettings{}));
}

void CaseFlags::resolve(const std::vector<SettingTarget>& settings, Console& console) const {
  HostSettings host;
  console_.apply(targets_of(console_table(), host));
  console.configure(host.console);
  own_.apply(settings);
}

FlagValues CaseFlags::common() const {
  SegmentSettings scratch;
  common_.apply(targets_of(segment_table(), scratch));  // throws what every case would say
  FlagValues common;
  for (const SettingEntry& entry : common_.entries()) common[entry.key->name] = common_.words(entry.key->name);
  if (!config_.empty()) common["config"] = {config_};
  return common;
}

BatchContext case_lines(Console& console) {
  BatchContext context;
  context.observer = console.observer();
  context.finished = [&](const BatchRow& row) {
    if (row.failed()) console.warn(fmt::format("{} ({}): {}", row.status, row.name, row.message));
    const std::string volume = row.volume_ml ? fmt::format("{:.6g}", *row.volume_ml) : "n/a";
    std::cout << fmt::format("{} {} {} {:.3f}\n", row.name, volume, row.status, row.seconds.value_or(0.0))
              << std::flush;
  };
  return context;
}

}  // namespace pellicle::cli
