#pragma once
/// Many segmentations, each in a process of its own, so that whatever happens to one is a row of the table.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "pellicle/base/observer.h"
#include "pellicle/batch/batch_table.h"
#include "pellicle/batch/manifest.h"

namespace pellicle {

struct BatchSettings {
  std::filesystem::path program;  ///< what is run, as `PROGRAM segment ...`
  std::filesystem::path output;   ///< the files of a case go to output/NAME/NAME_*
  FlagValues common;              ///< flags of every case, unless it has its own value
  std::string table;              ///< file name "batch-*.tsv" of the table; empty: by the shard
  Shard shard;
  int jobs = 1;             ///< cases at a time
  int threads = 0;          ///< of all cases together; 0: all cores
  bool resume = false;      ///< keep what an earlier run finished
  bool overwrite = false;   ///< start anew, replacing files
  bool keep_going = false;  ///< go on after a case that failed

  /// \throws UsageError.
  void validate() const;
};

struct BatchContext {
  std::function<void(const BatchRow&)> finished;  ///< after each case, in the order in which they end
  Observer observer;
};

struct BatchResult {
  std::vector<BatchRow> rows;  ///< of this shard's cases, in the order of the manifest
  std::filesystem::path table;
  std::size_t kept = 0;  ///< that an earlier run had finished

  /// 1 when a case failed, else 3 when a fit is not ok, else 0.
  int exit_code() const;
};

/// Runs the cases of the shard and keeps output/batch.tsv (of a shard: batch-I-of-N.tsv) complete: at every moment a
/// row for each case, "pending" until it has ended. With `resume` a case is kept when a table of the folder says that
/// it ended with 0 or 3 under the same arguments and its files are there. \throws UsageError; CannotCreate when the
/// table exists and neither resume nor overwrite is set; BadData for a broken
///         table; Interrupted, after the children have ended and the table is written.
BatchResult run_batch(const std::vector<BatchCase>& cases, const BatchSettings& settings, const BatchContext& context);

}  // namespace pellicle
