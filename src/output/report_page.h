#pragma once
/// Results as one page that needs nothing else: table, pictures, viewer, curves, settings, provenance.

#include <optional>
#include <string>
#include <vector>

#include "pellicle/base/observer.h"
#include "pellicle/output/page_case.h"

namespace pellicle {

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
