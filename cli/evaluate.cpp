#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "pellicle/base/atomic_file.h"
#include "pellicle/base/errors.h"
#include "pellicle/base/parallel.h"
#include "pellicle/output/evaluation_files.h"
#include "pellicle/output/outputs.h"

namespace pellicle::cli {

namespace {

struct EvaluateFlags {
  std::string truth, result;
  double tolerance_mm = 1.0;
  bool multi = false, overwrite = false;
  std::filesystem::path json;
  int threads = 0;
  ConsoleOptions* console = nullptr;
};

int run_evaluate(const EvaluateFlags& flags, Console& console) {
  console.configure(*flags.console);
  if (!(flags.tolerance_mm >= 0.0) || !std::isfinite(flags.tolerance_mm)) {
    throw UsageError(fmt::format("bad value (--tolerance-mm {}): must be 0 mm or more", flags.tolerance_mm));
  }
  if (!flags.json.empty()) check_outputs({flags.json}, flags.overwrite, {flags.truth, flags.result});
  const ThreadLimit limit(flags.threads);
  const EvaluationInput truth = read_evaluation_input(flags.truth), result = read_evaluation_input(flags.result);
  const Evaluation evaluation = evaluate_result(truth, result, flags.tolerance_mm, flags.multi);
  if (!flags.json.empty()) {
    create_folder(flags.json.parent_path());
    write_text_file(flags.json, json_of(evaluation).dump(2) + "\n");
  }
  std::cout << table_of(evaluation);
  return 0;
}

}  // namespace

Run add_evaluate(CLI::App& app) {
  auto flags = std::make_shared<EvaluateFlags>();
  app.add_option("TRUTH", flags->truth, "mask, label map, mesh, model or phantom JSON")->required();
  app.add_option("RESULT", flags->result, "the same kinds; they mix freely")->required();
  app.add_option("--tolerance-mm", flags->tolerance_mm, "of the normalised surface Dice, mm")
      ->type_name("T")
      ->capture_default_str()
      ->group("Metrics");
  app.add_flag("--multi", flags->multi, "also for each label, and f1 of the objects found at IoU 0.5")
      ->group("Metrics");
  app.add_option("--json", flags->json, "also write the figures here")->type_name("FILE")->group("Outputs");
  app.add_flag("--overwrite", flags->overwrite, "replace the JSON file when it exists")->group("Outputs");
  app.add_option("--threads", flags->threads, "threads; 0: all")->type_name("N")->capture_default_str()->group("Run");
  flags->console = add_console_flags(app);
  app.footer(
      "Distances are mm between surfaces, weighted by area; volumes ml; volume error is (result - truth) / truth.\n"
      "Both masks empty: dice 1; one empty: dice 0 and no distances.\n"
      "Example: pellicle evaluate truth.nii.gz out/scan_mask.nii.gz --json scores.json");
  return [flags](Console& console) { return run_evaluate(*flags, console); };
}

}  // namespace pellicle::cli
