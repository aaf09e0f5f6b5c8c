#pragma once
/// What a run would do, before it does it: the seeds as a picture and in words, and the files that it would write.

#include <filesystem>
#include <string>
#include <vector>

#include "pellicle/pipeline/segment.h"

namespace pellicle {

struct SeedPreview {
  std::filesystem::path picture;   ///< STEM_seeds.png
  std::vector<std::string> lines;  ///< one an object, then one a file
};

/// Reads the input and the seeds and draws STEM_seeds.png into the output folder; a picture of an earlier preview is
/// replaced. Seeds without a hint are those that the fit would try: candidates of one object, or the places of many.
/// \throws as segment, but for outputs that exist.
SeedPreview preview_seeds(const SegmentSettings& settings, const RunContext& context);

}  // namespace pellicle
