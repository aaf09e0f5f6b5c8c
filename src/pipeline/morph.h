#pragma once
/// Shapes between two saved models: from settings to files.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pellicle/mesh/measure.h"
#include "pellicle/pipeline/segment.h"
#include "pellicle/settings/morph_settings.h"
#include "pellicle/surface/morph.h"

namespace pellicle {

std::string stem_of(const MorphSettings& settings);
std::vector<double> taus_of(const MorphSettings& settings);

struct MorphStep {
  double tau = 0.0;
  Surface surface;
  TriangleMesh mesh = {};                ///< as written: outward, LPS mm
  FitStatus status = FitStatus::ok;      ///< or folded, or inside_out
  std::optional<double> volume_ml = {};  ///< of the smooth surface; none for open ones
  double area_mm2 = 0.0;
  std::size_t self_intersections = 0;
  bool watertight = false;
  int genus = 0;
};

struct MorphResult {
  MorphSettings settings;
  ShapeMoments moments;
  int points_a = 0, points_b = 0, points = 0;  ///< control points as read, and of every step
  double moved_a_mm = 0.0, moved_b_mm = 0.0;   ///< how far bringing both to one control mesh moved the surfaces
  std::vector<MorphStep> steps;
  std::vector<InputFile> inputs;
  std::vector<OutputFile> outputs;                      ///< all but the report itself
  std::vector<std::pair<std::string, double>> seconds;  ///< per phase
  int exit_code() const;                                ///< 0, or 3 when a step is not ok
};

/// Writes STEM_morph-001_surface.ply, STEM_morph-001_model.json ..., STEM_morph.tsv, STEM_morph.png and the report
/// STEM_morph.json. \throws what validate(), read_model, match_surfaces, morph_path and the writers throw; CannotCreate
/// when an output exists and overwrite is false (before any work); Interrupted.
MorphResult morph(const MorphSettings& settings, const RunContext& context);

nlohmann::ordered_json report_of(const MorphResult& result, const std::vector<std::string>& command_line);

}  // namespace pellicle
