#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "command_flags.h"
#include "commands.h"
#include "pellicle/base/atomic_file.h"
#include "pellicle/base/parallel.h"
#include "pellicle/output/evaluation_files.h"
#include "pellicle/output/outputs.h"
#include "pellicle/settings/evaluate_settings.h"

namespace pellicle::cli {

namespace {

int run_evaluate(const EvaluateSettings& settings, Console& /*console*/) {
  if (!settings.json.empty()) check_outputs({settings.json}, settings.overwrite, {settings.truth, settings.result});
  const ThreadLimit limit(settings.threads);
  const EvaluationInput truth = read_evaluation_input(settings.truth), result = read_evaluation_input(settings.result);
  const Evaluation evaluation = evaluate_result(truth, result, settings.tolerance_mm, settings.multi);
  if (!settings.json.empty()) {
    create_folder(settings.json.parent_path());
    write_text_file(settings.json, json_of(evaluation).dump(2) + "\n");
  }
  std::cout << table_of(evaluation);
  return 0;
}

}  // namespace

Run add_evaluate(CLI::App& app) {
  app.footer(
      "Distances are mm between surfaces, weighted by area; volumes ml; volume error is (result - truth) / truth.\n"
      "Both masks empty: dice 1; one empty: dice 0 and no distances.\n"
      "Example: pellicle evaluate truth.nii.gz out/scan_mask.nii.gz --json scores.json");
  return settings_command<EvaluateSettings>(app, evaluate_table(), run_evaluate);
}

}  // namespace pellicle::cli
