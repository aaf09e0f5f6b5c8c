#include "pellicle/batch/batch.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>

#include "case_flags.h"
#include "command_settings.h"
#include "commands.h"
#include "pellicle/base/child_process.h"
#include "pellicle/base/errors.h"

namespace pellicle::cli {

namespace {

bool is_table(const std::string& source) {
  const auto extension = std::filesystem::path(source).extension();
  return extension == ".csv" || extension == ".tsv";
}

std::vector<BatchCase> cases_from(const std::vector<std::string>& sources) {
  if (sources.size() == 1 && is_table(sources.front())) return read_manifest(sources.front());
  if (std::any_of(sources.begin(), sources.end(), is_table)) {
    throw SettingError("several sources", "MANIFEST", "one table, or volumes and patterns of them; give one kind");
  }
  return cases_of_patterns(sources);
}

BatchSettings settings_of(const BatchFlags& flags) {
  BatchSettings settings;
  settings.program = this_program();
  settings.output = flags.output;
  settings.shard = parse_shard(flags.shard);
  settings.jobs = flags.cases.jobs;
  settings.threads = flags.cases.threads;
  settings.resume = flags.resume;
  settings.overwrite = flags.cases.overwrite;
  settings.keep_going = flags.keep_going;
  return settings;
}

int run_batch_command(const CaseFlags& typed, Console& console) {
  BatchFlags flags;
  typed.resolve(targets_of(batch_table(), flags), console);
  BatchSettings settings = settings_of(flags);
  settings.common = typed.common();
  const BatchResult result = run_batch(cases_from(flags.manifest), settings, case_lines(console));
  if (result.kept > 0) console.inform(fmt::format("{} of {} cases were done before", result.kept, result.rows.size()));
  const auto pending =
      std::count_if(result.rows.begin(), result.rows.end(), [](const BatchRow& row) { return !row.exit_code; });
  if (pending > 0) {
    console.warn(fmt::format(
        "stopped after a case that failed; {} of {} cases are pending: --resume goes on, --keep-going does not stop",
        pending, result.rows.size()));
  }
  return result.exit_code();
}

}  // namespace

Run add_batch(CLI::App& app) {
  auto flags = std::make_shared<CaseFlags>();
  flags->declare(app, entries_of(batch_table(), BatchFlags{}), "cases");
  app.footer(
      "Flags of 'segment' hold for every case; the values of a row win over them.\n"
      "One line per case on stdout: name volume_ml status seconds. Exit code 3: a fit is not ok; 1: a case failed.\n"
      "Example: pellicle batch cases.csv -o out --preset bright --jobs 2 --keep-going --resume");
  return [flags](Console& console) { return run_batch_command(*flags, console); };
}

}  // namespace pellicle::cli
