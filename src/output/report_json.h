#pragma once
/// What every report says in the same words: the program, its inputs and outputs, and what the run took.

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "pellicle/base/geometry.h"
#include "pellicle/base/phase_clock.h"
#include "pellicle/image/image_grid.h"
#include "pellicle/output/run_record.h"

namespace pellicle {

/// The number, or null for one that is not finite or not there: JSON has no word for it.
nlohmann::ordered_json number_json(double value);
nlohmann::ordered_json number_json(std::optional<double> value);
nlohmann::ordered_json vector_json(const Vec3& v);

/// Grid of a volume: size, spacing_mm, origin_lps_mm, direction (rows), orientation.
nlohmann::ordered_json json_of(const ImageGrid& grid);

/// How a report begins: format, version, program with its libraries, command_line, finished, exit_code.
nlohmann::ordered_json report_head(const std::string& format, const RunRecord& record, int exit_code);

nlohmann::ordered_json inputs_json(const std::vector<InputFile>& files);
nlohmann::ordered_json outputs_json(const std::vector<OutputFile>& files);

/// How a report ends: seconds of each phase and in total, peak_memory_bytes.
void add_cost(const PhaseSeconds& seconds, nlohmann::ordered_json& report);

}  // namespace pellicle
