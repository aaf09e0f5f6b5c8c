#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <map>
#include <new>

#include "commands.h"
#include "exit_codes.h"
#include "flag_text.h"
#include "hosts/slicer_progress.h"
#include "pellicle/base/errors.h"
#include "pellicle/base/interrupt.h"
#include "pellicle/output/provenance.h"

namespace {

using pellicle::cli::Console;
using pellicle::cli::Run;

std::string subcommand_of(const CLI::App& app) {
  const auto chosen = app.get_subcommands();
  return chosen.empty() ? "pellicle" : "pellicle " + chosen.front()->get_name();
}

std::string version_text() {
  std::string libraries;
  for (const auto& [name, version] : pellicle::library_versions()) {
    libraries += fmt::format("{}{} {}", libraries.empty() ? "" : ", ", name, version);
  }
  return fmt::format("pellicle {}\n{}", pellicle::program_version(), libraries);
}

int report_usage(const CLI::App& app, const CLI::ParseError& fault, const std::vector<std::string>& command_line,
                 Console& console) {
  if (fault.get_exit_code() == 0) return app.exit(fault);  // --help and --version print on stdout
  const std::string program = subcommand_of(app);
  if (app.get_subcommands().empty() && command_line.size() > 1 && command_line[1].rfind('-', 0) != 0) {
    console.error(
        fmt::format("bad usage ({}): '{}' is not a subcommand; see '{} --help'", program, command_line[1], program));
    return pellicle::cli::kUsage;
  }
  console.error(fmt::format("bad usage ({}): {}; see '{} --help'", program, fault.what(), program));
  return pellicle::cli::kUsage;
}

int run(CLI::App& app, const std::map<const CLI::App*, Run>& commands, Console& console) {
  try {
    return commands.at(app.get_subcommands().front())(console);
  } catch (const pellicle::Interrupted& stop) {
    console.error(fmt::format("interrupted ({}): stopped by a signal; no half file is left", subcommand_of(app)));
    return pellicle::cli::exit_code_of(stop.category());
  } catch (const pellicle::Error& fault) {
    console.error(pellicle::cli::message_of(fault));
    return pellicle::cli::exit_code_of(fault.category());
  } catch (const std::bad_alloc&) {
    console.error(
        fmt::format("out of memory ({}): the data do not fit; use a smaller volume or machine with more memory",
                    subcommand_of(app)));
    return pellicle::cli::kFailure;
  } catch (const std::exception& fault) {
    console.error(
        fmt::format("internal error ({}): {}; please report this with the command", subcommand_of(app), fault.what()));
    return pellicle::cli::kFailure;
  }
}

}  // namespace

int main(int argc, char** argv) {
  pellicle::install_interrupt_handler();
  const std::vector<std::string> command_line(argv, argv + argc);
  Console console;
  // A fault of the command line itself is reported before its flags are known: --log-json is looked for here.
  for (const auto& word : command_line) {
    if (word == "--log-json") console.configure({false, false, true, false});
  }
  CLI::App app("Few-parameter deformable surfaces for 3D biomedical images", "pellicle");
  app.set_version_flag("--version", version_text());
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 success, 1 failure, 3 an object failed its own checks, 64 usage, 65 bad data, 66 no such input,\n"
      "73 cannot create output, 74 I/O error, 130 interrupted.\n"
      "Example: pellicle segment -i scan.nii.gz -o out --seed-sphere 12,-30,5,8");
  auto* segment = app.add_subcommand("segment", "volume -> fitted surface -> mask, mesh, model, report, picture");
  auto* phantom = app.add_subcommand("phantom", "synthetic volume with exact truth");
  auto* evaluate = app.add_subcommand("evaluate", "truth against result: overlap and surface distances");
  auto* save = app.add_subcommand("export", "a saved model -> mesh, mask, signed distance, control mesh");
  auto* fit = app.add_subcommand("fit", "points, mesh or mask -> fitted surface (no image)");
  auto* morph = app.add_subcommand("morph", "shapes between two saved models of one kind, and beyond");
  auto* batch = app.add_subcommand("batch", "a table of many segmentations, each in a process of its own");
  auto* bids = app.add_subcommand("bids", "a BIDS dataset -> a BIDS derivatives dataset");
  auto* report = app.add_subcommand("report", "results -> one self-contained HTML page");
  auto* info = app.add_subcommand("info", "what a file holds: grid, frame, spacing, type, range");
  auto* completion = app.add_subcommand("completion", "completion of commands and flags for a shell");
  auto* manual = app.add_subcommand("manual", "the manual page of a command");
  const std::map<const CLI::App*, Run> commands{{segment, pellicle::cli::add_segment(*segment, command_line)},
                                                {phantom, pellicle::cli::add_phantom(*phantom)},
                                                {evaluate, pellicle::cli::add_evaluate(*evaluate)},
                                                {save, pellicle::cli::add_export(*save)},
                                                {fit, pellicle::cli::add_fit(*fit, command_line)},
                                                {morph, pellicle::cli::add_morph(*morph, command_line)},
                                                {batch, pellicle::cli::add_batch(*batch)},
                                                {bids, pellicle::cli::add_bids(*bids)},
                                                {report, pellicle::cli::add_report(*report)},
                                                {info, pellicle::cli::add_info(*info)},
                                                {completion, pellicle::cli::add_completion(*completion, app)},
                                                {manual, pellicle::cli::add_manual(*manual, app)}};
  try {
    std::vector<std::string> words(command_line.begin() + 1, command_line.end());
    const bool has_hosts = !words.empty() && (words.front() == "segment" || words.front() == "bids");
    if (has_hosts) words = pellicle::cli::with_dashed_flags(words);
    std::reverse(words.begin(), words.end());  // CLI11 takes them from the back
    app.parse(words);
  } catch (const CLI::ParseError& fault) {
    return report_usage(app, fault, command_line, console);
  }
  const int code = run(app, commands, console);
  std::cout.flush();
  return code;
}
