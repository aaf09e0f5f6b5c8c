#pragma once
/// What is known of the cases of a batch: a tab-separated table, for people, spreadsheets and a later run.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pellicle/batch/manifest.h"

namespace pellicle {

/// Columns in this order; numbers that do not exist are "n/a".
struct BatchRow {
  std::string name;
  std::string status = "pending";  ///< of the fit (of several objects: the first that is not ok), "failed" or "pending"
  std::optional<int> exit_code;    ///< of `pellicle segment`; 128 + signal when a signal ended it
  std::optional<double> seconds;
  std::optional<double> volume_ml;  ///< sum over the objects
  std::optional<int> objects;
  std::optional<double> peak_memory_mb;
  std::string arguments;  ///< fingerprint of what the case was told, so that a change is seen
  std::string message;    ///< why it failed

  bool done() const { return exit_code == 0 || exit_code == 3; }
  bool failed() const { return exit_code.has_value() && !done(); }
};

/// "batch.tsv", or "batch-2-of-8.tsv" for a part.
std::string table_name(const Shard& shard);

std::string table_of(const std::vector<BatchRow>& rows);
/// \throws BadData when the file is not such a table, IoError.
std::vector<BatchRow> read_batch_table(const std::filesystem::path& path);
/// Rows of all tables of a batch's folder, those of whole batches first; none when there is no table yet.
std::vector<BatchRow> read_batch_tables(const std::filesystem::path& folder);

/// What `pellicle segment` said on stdout and how it ended.
void fill_row(BatchRow& row, const std::string& out, const std::string& err, int exit_code, int signal);

}  // namespace pellicle
