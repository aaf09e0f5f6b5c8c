#pragma once
/// Results as one page that needs nothing else: table, pictures, viewer, curves, settings, provenance.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pellicle/fit/fit.h"
#include "pellicle/pipeline/batch_table.h"

namespace pellicle {

/// One case of a page: its report, its row in a batch's table, or both.
struct PageCase {
  std::string name;
  std::optional<std::filesystem::path> report;
  std::optional<BatchRow> row;
};

struct PageSettings {
  std::string title;
  bool viewer = true;       ///< with volumes, surfaces and the viewer itself
  std::optional<int> edge;  ///< volumes hold at most edge^3 voxels; default: 128, fewer when there are many cases
};

/// Reports (files), and folders: of a batch (the cases of its tables), or with reports anywhere below (sorted by path).
/// A case that several sources name comes once. \throws NoInput when a source has no result.
std::vector<PageCase> find_page_cases(const std::vector<std::filesystem::path>& sources);

/// HTML. Inputs and outputs of a case are sought beside its report and where the report says; what is missing or
/// changed is left out and said so on the page. The same files give the same bytes. \throws BadData when a report is
/// none; Interrupted.
std::string page_of(const std::vector<PageCase>& cases, const PageSettings& settings, const Progress& progress);

}  // namespace pellicle
