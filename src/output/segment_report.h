#pragma once
/// The report of a segmentation as JSON; its schema is docs/report.schema.json.

#include <nlohmann/json_fwd.hpp>

#include "pellicle/output/segment_files.h"

namespace pellicle {

nlohmann::ordered_json report_of(const SegmentResult& result, const RunRecord& record);

}  // namespace pellicle
