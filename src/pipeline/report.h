#pragma once
/// The report of a run as JSON; its schema is docs/report.schema.json.

#include <nlohmann/json_fwd.hpp>

#include "pellicle/pipeline/segment.h"

namespace pellicle {

/// \param context the command line as typed, and the preset that was chosen.
nlohmann::ordered_json report_of(const SegmentResult& result, const RunContext& context);

/// Grid of a volume as JSON: size, spacing_mm, origin_lps_mm, direction (rows), orientation.
nlohmann::ordered_json json_of(const ImageGrid& grid);

/// Where the index axes point to, nearest anatomical direction each: "RAS" for +i right, +j anterior, +k superior.
std::string orientation_code(const ImageGrid& grid);

}  // namespace pellicle
