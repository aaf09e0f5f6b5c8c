#pragma once
/// Results as one page that needs nothing else: table, pictures, viewer, curves, settings, provenance.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pellicle/base/observer.h"

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

struct PageSettings {
  std::string title;
  bool viewer = true;       ///< with volumes, surfaces and the viewer itself
  std::optional<int> edge;  ///< volumes hold at most edge^3 voxels; default: 128, fewer when there are many cases
};

/// HTML. Inputs and outputs of a case are sought beside its report and where the report says; what is missing or
/// changed is left out, and the page says so. The same files give the same bytes.
/// \throws BadData when a report is not one; Interrupted.
std::string page_of(const std::vector<PageCase>& cases, const PageSettings& settings, const Observer& observer);

}  // namespace pellicle
