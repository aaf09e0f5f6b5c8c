#pragma once
/// The way of a fit as files: a mesh every few steps, a table of them and a picture of all.

#include <filesystem>
#include <string>
#include <vector>

#include "pellicle/base/observer.h"
#include "pellicle/fit/fit_types.h"
#include "pellicle/mesh/files/mesh_file.h"

namespace pellicle {

struct TraceFiles {
  std::filesystem::path folder;
  std::string stem;
  MeshFormat mesh_format = MeshFormat::ply;
  std::optional<int> mesh_density;  ///< 2^N facets along a control edge; default: to look at
};

/// \throws CannotCreate when the folder cannot be written, or holds a trace of this stem and `overwrite` is false.
void check_trace(const TraceFiles& files, bool overwrite);

/// Removes what an earlier run left under these names, so that traces do not mix.
void clear_trace(const TraceFiles& files);

/// STEM_trace-0001.ply ... in the order of the fit (names sort), STEM_trace.tsv (frame, stage, step, control points,
/// volume) and STEM_trace.png, each complete or not there. \param label above 0: one of several objects,
/// STEM_trace-LLL-0001.ply and so on. Returns the paths.
/// \throws CannotCreate, IoError, Interrupted.
std::vector<std::filesystem::path> write_trace(const TraceFiles& files, const std::vector<TraceFrame>& frames,
                                               int label, const Observer& observer);

}  // namespace pellicle
