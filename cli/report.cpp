#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "commands.h"
#include "pellicle/base/atomic_file.h"
#include "pellicle/base/errors.h"
#include "pellicle/base/parallel.h"
#include "pellicle/batch/page_cases.h"
#include "pellicle/output/outputs.h"

namespace pellicle::cli {

namespace {

struct ReportFlags {
  std::vector<std::filesystem::path> sources;
  std::filesystem::path output;
  PageSettings page;
  bool no_viewer = false, overwrite = false;
  int threads = 0;
  ConsoleOptions* console = nullptr;
};

int run_report(const ReportFlags& flags, Console& console) {
  console.configure(*flags.console);
  PageSettings settings = flags.page;
  settings.viewer = !flags.no_viewer;
  if (settings.edge && (*settings.edge < 8 || *settings.edge > 512)) {
    throw UsageError(fmt::format("bad value (--voxels {}): must be 8 to 512", *settings.edge));
  }
  const auto cases = find_page_cases(flags.sources);
  std::vector<std::filesystem::path> inputs = flags.sources;
  for (const auto& one : cases) {
    if (one.report) inputs.push_back(*one.report);
  }
  check_outputs({flags.output}, flags.overwrite, inputs);
  const ThreadLimit limit(flags.threads);
  const std::string page = page_of(cases, settings, console.observer());
  create_folder(flags.output.parent_path());
  write_text_file(flags.output, page);
  console.inform(fmt::format("{}: {} cases, {:.1f} MB", flags.output.string(), cases.size(),
                             static_cast<double>(page.size()) / 1e6));
  return 0;
}

}  // namespace

Run add_report(CLI::App& app) {
  auto flags = std::make_shared<ReportFlags>();
  app.add_option("RESULT", flags->sources, "folders of 'segment' or 'batch', or *_report.json files")->required();
  app.add_option("-o,--output", flags->output, "the page")->type_name("FILE.html")->required()->group("Outputs");
  app.add_option("--title", flags->page.title, "heading of the page")->type_name("TEXT")->group("Outputs");
  app.add_option("--voxels", flags->page.edge,
                 "volumes are cut out and averaged to at most N x N x N voxels; default 128, fewer for many cases")
      ->type_name("N")
      ->group("Outputs");
  app.add_flag("--no-viewer", flags->no_viewer, "without volumes and surfaces: a small page")->group("Outputs");
  app.add_flag("--overwrite", flags->overwrite, "replace the page when it exists")->group("Outputs");
  app.add_option("--threads", flags->threads, "threads; 0: all")->type_name("N")->capture_default_str()->group("Run");
  flags->console = add_console_flags(app);
  app.footer(
      "One file that needs no network: table, pictures, an interactive viewer, curves, settings, provenance.\n"
      "Example: pellicle report out -o report.html");
  return [flags](Console& console) { return run_report(*flags, console); };
}

}  // namespace pellicle::cli
