#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "command_flags.h"
#include "command_settings.h"
#include "commands.h"
#include "pellicle/base/atomic_file.h"
#include "pellicle/base/errors.h"
#include "pellicle/base/parallel.h"
#include "pellicle/batch/page_cases.h"
#include "pellicle/output/outputs.h"

namespace pellicle::cli {

namespace {

int run_report(const ReportSettings& settings, Console& console) {
  const PageSettings page_settings{settings.title, !settings.no_viewer, settings.voxels};
  const std::vector<std::filesystem::path> sources(settings.results.begin(), settings.results.end());
  const auto cases = find_page_cases(sources);
  std::vector<std::filesystem::path> inputs = sources;
  for (const auto& one : cases) {
    if (one.report) inputs.push_back(*one.report);
  }
  check_outputs({settings.output}, settings.overwrite, inputs);
  const ThreadLimit limit(settings.threads);
  const std::string page = page_of(cases, page_settings, console.observer());
  create_folder(settings.output.parent_path());
  write_text_file(settings.output, page);
  console.inform(fmt::format("{}: {} cases, {:.1f} MB", settings.output.string(), cases.size(),
                             static_cast<double>(page.size()) / 1e6));
  return 0;
}

}  // namespace

Run add_report(CLI::App& app) {
  app.footer(
      "One file that needs no network: table, pictures, an interactive viewer, curves, settings, provenance.\n"
      "Example: pellicle report out -o report.html");
  return settings_command<ReportSettings>(app, report_table(), run_report);
}

}  // namespace pellicle::cli
