#pragma once
/// The report of `pellicle fit` as JSON, and the picture of a ladder.

#include <nlohmann/json_fwd.hpp>

#include "pellicle/output/fit_files.h"
#include "pellicle/picture/canvas.h"

namespace pellicle {

nlohmann::ordered_json report_of(const GeometryFitResult& result, const RunRecord& record);

/// Residuals (rms, 95th percentile, max; % of the diameter) against the number of control points, both logarithmic.
Canvas ladder_picture(const GeometryFitResult& result);

}  // namespace pellicle
