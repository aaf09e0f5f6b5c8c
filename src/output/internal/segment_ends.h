#pragma once
/// The two ends of a segmentation with files: hashes of what is read, and everything that is written.

#include <future>
#include <string>
#include <vector>

#include "pellicle/output/outputs.h"
#include "pellicle/output/segment_files.h"
#include "pellicle/output/trace.h"

namespace pellicle {

/// Every file that a run reads, the volume first.
std::vector<std::filesystem::path> input_paths(const SegmentSettings& settings);

/// SHA-256 of the inputs, computed while the run goes on.
class InputHashes {
 public:
  explicit InputHashes(const SegmentSettings& settings);
  std::vector<InputFile> collect();

 private:
  std::vector<std::string> roles_;
  std::vector<std::filesystem::path> paths_;
  std::vector<std::future<std::string>> hashes_;
};

/// \throws as check_outputs.
std::vector<PlannedFile> checked_plan(const SegmentSettings& settings, const std::vector<int>& labels);
TraceFiles trace_files(const SegmentSettings& settings);

/// Masks, maps, tables, meshes, models and traces; the latter are added to the plan. Removes what an earlier run left.
/// \throws CannotCreate, IoError, Interrupted.
void write_results(const SegmentResult& result, const Observer& observer, std::vector<PlannedFile>& plan);
/// \pre the image was kept.
void write_qc(const SegmentResult& result, const std::vector<PlannedFile>& plan);
void write_convergence(const SegmentResult& result, const std::vector<PlannedFile>& plan);

}  // namespace pellicle
