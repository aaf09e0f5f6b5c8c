#include "case_flags.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>

#include "commands.h"

namespace pellicle::cli {

void CaseFlags::add(CLI::App& app, const std::string& cases) {
  const auto number = [&app](const std::string& name, int& value, const std::string& help) {
    app.add_option(name, value, help)->type_name("N")->capture_default_str()->group("Run");
  };
  number("--jobs", jobs, cases + " at a time; they share the threads");
  number("--threads", threads, fmt::format("threads of all {} together; 0: all", cases));
  app.add_option("--config", config, "settings file for all " + cases)->type_name("FILE.toml")->group("Run");
  add_common_setting_flags(app, typed);
  console = add_console_flags(app);
}

FlagValues CaseFlags::common() const {
  return common_values(typed, config);
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
