#pragma once
/// One case as a page needs it: numbers from its report, and what is made anew from its files.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "pellicle/output/report_page.h"

namespace pellicle {

/// How large the parts of one case may be.
struct PageLimits {
  int edge = 128;                      ///< volume: edge^3 voxels
  std::size_t most_triangles = 30000;  ///< all surfaces
};

struct PageParts {
  nlohmann::ordered_json facts;  ///< what the page's script reads
  std::string volume;            ///< .nii.gz; empty: none
  std::string mesh;              ///< gzip of MZ3; empty: none
};

/// \param scratch an existing folder for files on the way. \throws BadData, Interrupted.
PageParts page_parts(const PageCase& one, const PageLimits& limits, bool viewer, const std::filesystem::path& scratch);

std::string base64_of(const std::string& bytes);

}  // namespace pellicle
