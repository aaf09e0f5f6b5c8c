#include "pellicle/batch/bids.h"

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

struct BidsFlags {
  BidsSettings bids;
  std::string level;
  CaseFlags cases;
};

int run_participants(const BidsSettings& settings, Console& console) {
  const BatchResult result = run_bids_participants(settings, case_lines(console));
  if (result.kept > 0) console.inform(fmt::format("{} of {} images were done before", result.kept, result.rows.size()));
  return result.exit_code();
}

int run_bids(const BidsFlags& flags, Console& console) {
  console.configure(*flags.cases.console);
  BidsSettings settings = flags.bids;
  settings.program = this_program();
  settings.jobs = flags.cases.jobs;
  settings.threads = flags.cases.threads;
  settings.common = flags.cases.common();
  if (flags.cases.config.empty()) settings.common.try_emplace("preset", std::vector<std::string>{"brain-t1"});
  settings.common.try_emplace("write", std::vector<std::string>{"mask,mesh,model,report,qc"});
  if (flags.level == "participant") return run_participants(settings, console);
  if (flags.level == "group") {
    const auto page = write_bids_group_page(settings, console.observer());
    console.inform(page.string());
    return 0;
  }
  throw UsageError(fmt::format("bad value (LEVEL): '{}' is no level; use participant or group", flags.level));
}

}  // namespace

Run add_bids(CLI::App& app) {
  auto flags = std::make_shared<BidsFlags>();
  app.add_option("BIDS_DIR", flags->bids.dataset, "a raw BIDS dataset")->required();
  app.add_option("OUT", flags->bids.output, "the derivatives dataset, created if missing")->required();
  app.add_option("LEVEL", flags->level, "participant: segment every image; group: the page of all results")->required();
  app.add_option("--participant-label,--participant_label", flags->bids.participants,
                 "only these, with or without 'sub-'; default: all")
      ->type_name("LABEL ...")
      ->group("Dataset");
  app.add_option("--session-label,--session_label", flags->bids.sessions,
                 "only these, with or without 'ses-'; default: all")
      ->type_name("LABEL ...")
      ->group("Dataset");
  app.add_option("--suffix", flags->bids.suffix, "which images of anat/")
      ->type_name("SUFFIX")
      ->capture_default_str()
      ->group("Dataset");
  app.add_option("--desc", flags->bids.desc, "what the results are called: ..._desc-LABEL_mask.nii.gz")
      ->type_name("LABEL")
      ->capture_default_str()
      ->group("Dataset");
  app.add_flag("--overwrite", flags->bids.overwrite, "do again what an earlier run finished")->group("Run");
  flags->cases.add(app, "images");
  app.footer(
      "Flags of 'segment' hold for every image; without --preset or --config it is brain-t1. A run goes on where an "
      "earlier one\n"
      "stopped. One line an image on stdout: name volume_ml status seconds. Exit codes as of 'batch'.\n"
      "Example: pellicle bids study study/derivatives/pellicle participant --participant-label 01 02");
  return [flags](Console& console) { return run_bids(*flags, console); };
}

}  // namespace pellicle::cli
