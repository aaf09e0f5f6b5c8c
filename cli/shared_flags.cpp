#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "commands.h"
#include "pellicle/base/errors.h"
#include "pellicle/pipeline/settings.h"

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
