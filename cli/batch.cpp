#include "pellicle/batch/batch.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>

#include "case_flags.h"
#include "commands.h"
#include "pellicle/base/child_process.h"
#include "pellicle/base/errors.h"
#include "pellicle/settings/settings.h"

namespace pellicle::cli {

namespace {

struct BatchFlags {
  std::vector<std::string> sources;  ///< one table, or patterns
  std::string shard = "1/1";
  BatchSettings batch;
  CaseFlags cases;
};

bool is_table(const std::string& source) {
  const auto extension = std::filesystem::path(source).extension();
  return extension == ".csv" || extension == ".tsv";
}

std::vector<BatchCase> cases_from(const std::vector<std::string>& sources) {
  if (sources.size() == 1 && is_table(sources.front())) return read_manifest(sources.front());
  if (std::any_of(sources.begin(), sources.end(), is_table)) {
    throw UsageError("several sources (MANIFEST): one table, or volumes and patterns of them; give one kind");
  }
  return cases_of_patterns(sources);
}

int run_batch_command(BatchFlags& flags, Console& console) {
  console.configure(*flags.cases.console);
  BatchSettings settings = flags.batch;
  settings.program = this_program();
  settings.shard = parse_shard(flags.shard);
  settings.jobs = flags.cases.jobs;
  settings.threads = flags.cases.threads;
  settings.common = flags.cases.common();
  const BatchResult result = run_batch(cases_from(flags.sources), settings, case_lines(console));
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
  auto flags = std::make_shared<BatchFlags>();
  app.add_option("MANIFEST", flags->sources,
                 "table (.csv, .tsv): a column a flag of 'segment', a row a case; or volumes, also as a pattern: "
                 "'scans/*.nii.gz'")
      ->required();
  app.add_option("-o,--output", flags->batch.output, "folder: batch.tsv, and a folder for each case")
      ->type_name("DIR")
      ->group("Batch");
  app.add_flag("--resume", flags->batch.resume, "do only what is missing in DIR, or was told otherwise")
      ->group("Batch");
  app.add_option("--shard", flags->shard, "only part I of N of the cases, from 1; its table is batch-I-of-N.tsv")
      ->type_name("I/N")
      ->group("Batch");
  app.add_flag("--keep-going", flags->batch.keep_going, "go on after a case that failed")->group("Batch");
  app.add_flag("--overwrite", flags->batch.overwrite, "start anew and replace files")->group("Batch");
  flags->cases.add(app, "cases");
  app.footer(
      "Flags of 'segment' that stand here hold for every case; what a row says wins.\n"
      "One line a case on stdout: name volume_ml status seconds. Exit code 3: a fit is not ok; 1: a case failed.\n"
      "Example: pellicle batch cases.csv -o out --preset bright --jobs 2 --keep-going --resume");
  return [flags](Console& console) { return run_batch_command(*flags, console); };
}

}  // namespace pellicle::cli
