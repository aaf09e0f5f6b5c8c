#pragma once
/// Shapes between two saved models, with files at both ends.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "pellicle/job/morph.h"
#include "pellicle/output/run_record.h"
#include "pellicle/settings/morph_settings.h"

namespace pellicle {

std::string stem_of(const MorphSettings& settings);
MorphOptions options_of(const MorphSettings& settings);

struct MorphResult {
  MorphSettings settings;
  Morphing morphing;
  std::vector<InputFile> inputs;
  std::vector<OutputFile> outputs;  ///< all but the report itself
  PhaseSeconds seconds;
  int exit_code() const;  ///< 0, or 3 when a step is not ok
};

/// Writes STEM_morph-001_surface.ply, STEM_morph-001_model.json ..., STEM_morph.tsv, STEM_morph.png and the report
/// STEM_morph.json.
/// \throws what validate(), read_model, morph and the writers throw; CannotCreate when an output exists and overwrite
/// is false (before any work); Interrupted.
MorphResult morph_to_files(const MorphSettings& settings, const RunRecord& record, const Observer& observer);

nlohmann::ordered_json report_of(const MorphResult& result, const RunRecord& record);

}  // namespace pellicle
