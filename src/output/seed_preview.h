#pragma once
/// What a run would do, before it does it: the seeds as a picture and in words, and the files that it would write.

#include <filesystem>
#include <string>
#include <vector>

#include "pellicle/output/segment_files.h"

namespace pellicle {

struct SeedPreview {
  std::filesystem::path picture;   ///< STEM_seeds.png
  std::vector<std::string> lines;  ///< one for each object, then one for each file
};

/// Reads the input and the seeds and draws STEM_seeds.png into the output folder; a picture of an earlier preview is
/// replaced. Seeds without a hint are those that the fit would try: candidates of one object, or the places of many.
/// \throws as segment_to_files, but for outputs that exist.
SeedPreview preview_seeds(const SegmentSettings& settings, const Observer& observer);

}  // namespace pellicle
