#pragma once
/// Which results come on a page: the cases of a batch, or every report of a folder.

#include <filesystem>
#include <vector>

#include "pellicle/output/report_page.h"

namespace pellicle {

/// Reports (files), and folders: of a batch (the cases of its tables), or with reports anywhere below (sorted by path).
/// A case that several sources name comes once.
/// \throws NoInput when a source has no result.
std::vector<PageCase> find_page_cases(const std::vector<std::filesystem::path>& sources);

}  // namespace pellicle
