#include "pellicle/batch/bids.h"

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

int run_participants(const BidsSettings& settings, Console& console) {
  const BatchResult result = run_bids_participants(settings, case_lines(console));
  if (result.kept > 0) console.inform(fmt::format("{} of {} images were done before", result.kept, result.rows.size()));
  return result.exit_code();
}

BidsSettings settings_of(const BidsFlags& flags) {
  BidsSettings settings;
  settings.program = this_program();
  settings.dataset = flags.dataset;
  settings.output = flags.output;
  settings.participants = flags.participants;
  settings.sessions = flags.sessions;
  settings.suffix = flags.suffix;
  settings.desc = flags.desc;
  settings.jobs = flags.cases.jobs;
  settings.threads = flags.cases.threads;
  settings.overwrite = flags.cases.overwrite;
  return settings;
}

int run_bids(const CaseFlags& typed, Console& console) {
  BidsFlags flags;
  typed.resolve(targets_of(bids_table(), flags), console);
  BidsSettings settings = settings_of(flags);
  settings.common = typed.common();
  if (typed.config().empty()) settings.common.try_emplace("preset", std::vector<std::string>{"brain-t1"});
  settings.common.try_emplace("write", std::vector<std::string>{"mask,mesh,model,report,qc"});
  if (flags.level == "participant") return run_participants(settings, console);
  if (flags.level == "group") {
    const auto page = write_bids_group_page(settings, console.observer());
    console.inform(page.string());
    return 0;
  }
  throw SettingError("bad value", "LEVEL", fmt::format("'{}' is not a level; use participant or group", flags.level));
}

}  // namespace

Run add_bids(CLI::App& app) {
  auto flags = std::make_shared<CaseFlags>();
  flags->declare(app, entries_of(bids_table(), BidsFlags{}), "images");
  app.footer(
      "Flags of 'segment' hold for every image; without --preset or --config it is brain-t1. A run goes on where an "
      "earlier one\n"
      "stopped. One line per image on stdout: name volume_ml status seconds. Exit codes as those of 'batch'.\n"
      "Example: pellicle bids study study/derivatives/pellicle participant --participant-label 01 02");
  return [flags](Console& console) { return run_bids(*flags, console); };
}

}  // namespace pellicle::cli
