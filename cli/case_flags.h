#pragma once
/// What `batch` and `bids` share: many cases, each a run of `segment` of its own, some at a time.

#include <string>
#include <vector>

#include "console.h"
#include "pellicle/batch/batch.h"

namespace CLI {
class App;
}

namespace pellicle::cli {

/// --jobs, --threads, --config, the flags of `segment` that hold for every case, and those of the console.
struct CaseFlags {
  int jobs = 1, threads = 0;
  std::string config;
  std::vector<std::vector<std::string>> typed;
  ConsoleOptions* console = nullptr;

  /// Declares them; `*this` must live as long as the app. \param cases what a case is called: "images".
  void add(CLI::App& app, const std::string& cases);
  /// What was said of every case. \throws UsageError.
  FlagValues common() const;
};

/// A line on stdout for each case that ends, a warning for each that failed, and the progress of all.
BatchContext case_lines(Console& console);

}  // namespace pellicle::cli
