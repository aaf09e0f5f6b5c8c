#pragma once
/// One result that comes on a page.

#include <filesystem>
#include <optional>
#include <string>

namespace pellicle {

/// How the run of a case ended, as a batch notes it.
struct CaseOutcome {
  std::string status;   ///< of the fit, or "failed" or "pending"
  std::string message;  ///< why it failed
  std::optional<double> seconds;
  bool done = false;  ///< it ended with its files written
};

/// One case of a page: its report, its outcome in a batch, or both.
struct PageCase {
  std::string name;
  std::optional<std::filesystem::path> report;
  std::optional<CaseOutcome> outcome;
};

}  // namespace pellicle
