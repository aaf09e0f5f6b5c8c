#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "commands.h"
#include "pellicle/base/errors.h"
#include "pellicle/settings/settings.h"

namespace pellicle::cli {

ConsoleOptions* add_console_flags(CLI::App& app) {
  // Lives as long as the app: CLI11 writes through the pointers while it parses.
  auto options = std::make_shared<ConsoleOptions>();
  app.add_flag("-q,--quiet", options->quiet, "errors only on stderr")->group("Run");
  app.add_flag("-v,--verbose", options->verbose, "tell what is going on")->group("Run");
  app.add_flag("--log-json", options->json, "logs as one JSON object a line")->group("Run");
  app.add_flag("--no-progress", options->no_progress, "no progress bar")->group("Run");
  app.callback([options] {});  // the callback owns them
  return options.get();
}

void add_common_setting_flags(CLI::App& app, std::vector<std::vector<std::string>>& typed) {
  const auto& keys = segment_keys();
  typed.resize(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const bool common = may_vary(keys[i].name) && keys[i].name != "input" && keys[i].name != "name";
    if (common) add_setting_flag(app, keys[i], typed[i]);
  }
}

FlagValues common_values(const std::vector<std::vector<std::string>>& typed, const std::string& config) {
  FlagValues common;
  const auto& keys = segment_keys();
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const auto& values = typed[i];
    if (values.empty()) continue;
    SegmentSettings scratch;
    const bool list = keys[i].kind == SettingKind::words || keys[i].kind == SettingKind::vector;
    keys[i].set(scratch, list ? split_commas(values.front()) : values, "--" + keys[i].name);
    common[keys[i].name] = values;
  }
  if (!config.empty()) common["config"] = {config};
  return common;
}

std::vector<double> three_numbers(const std::string& text, const std::string& where) {
  std::vector<double> numbers;
  for (const auto& word : split_commas(text)) numbers.push_back(number_of(word, where));
  if (numbers.size() == 1) numbers.resize(3, numbers[0]);
  if (numbers.size() != 3) {
    throw UsageError(
        fmt::format("bad value ({}): 3 numbers are needed, separated by commas, not {}", where, numbers.size()));
  }
  return numbers;
}

}  // namespace pellicle::cli
