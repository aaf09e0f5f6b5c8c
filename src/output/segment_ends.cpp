#include <fmt/format.h>

#include <algorithm>

#include "pellicle/base/atomic_file.h"
#include "pellicle/job/measure.h"
#include "pellicle/output/convergence_picture.h"
#include "pellicle/output/internal/segment_ends.h"
#include "pellicle/output/label_table.h"
#include "pellicle/output/qc_picture.h"
#include "pellicle/output/seed_files.h"
#include "pellicle/surface/model_file.h"

namespace pellicle {
namespace fs = std::filesystem;

namespace {

// 0/1 of one object, labels of several.
void write_mask(const fs::path& path, const SegmentResult& result) {
  const Image<std::uint16_t>& labels = result.segmentation.labels;
  if (result.writes_labels()) {
    write_volume(path, labels, result.header);
    return;
  }
  Image<std::uint8_t> mask(labels.grid);
  std::transform(labels.voxels.begin(), labels.voxels.end(), mask.voxels.begin(),
                 [](std::uint16_t label) { return static_cast<std::uint8_t>(label != 0 ? 1 : 0); });
  write_volume(path, mask, result.header);
}

void write_maps(const SegmentResult& result, const std::vector<PlannedFile>& plan) {
  const SegmentSettings& settings = result.settings;
  if (settings.writes("mask")) {
    write_mask(path_of(plan, "mask"), result);
    if (result.writes_labels()) write_text_file(path_of(plan, "labels"), label_table(result.segmentation.objects));
  }
  if (settings.writes("sdf")) write_volume(path_of(plan, "sdf"), result.segmentation.distance, result.header);
  if (settings.writes("prob")) write_volume(path_of(plan, "prob"), result.segmentation.fraction, result.header);
  if (settings.output_mask) write_mask(*settings.output_mask, result);
}

void write_objects(const SegmentResult& result, const Observer& observer, const std::vector<PlannedFile>& plan) {
  const SegmentSettings& settings = result.settings;
  const std::vector<ObjectResult>& objects = result.segmentation.objects;
  if (settings.output_mesh) {
    write_mesh(*settings.output_mesh, merged_mesh(objects), mesh_format_of_path(*settings.output_mesh));
  }
  for (const auto& object : objects) {
    const int label = result.writes_labels() ? object.label : 0;
    if (settings.writes("mesh")) write_mesh(path_of(plan, "mesh", label), object.mesh, settings.mesh_format);
    if (settings.writes("model")) write_model(path_of(plan, "model", label), object.surface);
    observer.check_stopped();
  }
}

void write_traces(const SegmentResult& result, const Observer& observer, std::vector<PlannedFile>& plan) {
  const TraceFiles files = trace_files(result.settings);
  clear_trace(files);
  for (const auto& object : result.segmentation.objects) {
    const int label = result.writes_labels() ? object.label : 0;
    for (const auto& path : write_trace(files, object.trace, label, observer)) plan.push_back({"trace", label, path});
  }
}

std::vector<fs::path> output_folders(const SegmentSettings& settings) {
  std::vector<fs::path> folders{settings.output};
  for (const auto& file : {settings.output_mask, settings.output_mesh}) {
    if (file) folders.push_back(file->parent_path());
  }
  return folders;
}

}  // namespace

std::vector<fs::path> input_paths(const SegmentSettings& settings) {
  std::vector<fs::path> paths{settings.input};
  if (settings.seeds_file) paths.push_back(*settings.seeds_file);
  if (settings.seed_mask) paths.push_back(parse_mask_argument(*settings.seed_mask).file);
  if (settings.seed_model) paths.push_back(*settings.seed_model);
  if (settings.points) paths.push_back(*settings.points);
  return paths;
}

InputHashes::InputHashes(const SegmentSettings& settings) : roles_{"volume"}, paths_(input_paths(settings)) {
  if (settings.seeds_file) roles_.emplace_back("seeds");
  if (settings.seed_mask) roles_.emplace_back("seed-mask");
  if (settings.seed_model) roles_.emplace_back("seed-model");
  if (settings.points) roles_.emplace_back("points");
  for (const auto& path : paths_) hashes_.push_back(std::async(std::launch::async, sha256_of, path));
}

std::vector<InputFile> InputHashes::collect() {
  std::vector<InputFile> files;
  for (std::size_t i = 0; i < paths_.size(); ++i) files.push_back({roles_[i], paths_[i], hashes_[i].get()});
  return files;
}

std::vector<PlannedFile> checked_plan(const SegmentSettings& settings, const std::vector<int>& labels) {
  auto plan = plan_outputs(settings, labels);
  check_outputs(paths_of(plan), settings.overwrite, input_paths(settings));
  return plan;
}

TraceFiles trace_files(const SegmentSettings& settings) {
  return {*settings.trace, stem_of(settings), settings.mesh_format, settings.mesh_density};
}

void write_results(const SegmentResult& result, const Observer& observer, std::vector<PlannedFile>& plan) {
  const SegmentSettings& settings = result.settings;
  for (const fs::path& folder : output_folders(settings)) create_folder(folder);
  for (const auto& path : stale_outputs(settings, plan)) {
    std::error_code ignored;
    fs::remove(path, ignored);
  }
  write_maps(result, plan);
  write_objects(result, observer, plan);
  if (settings.trace) write_traces(result, observer, plan);
}

void write_qc(const SegmentResult& result, const std::vector<PlannedFile>& plan) {
  const auto draw = result.settings.wants_many() ? overview_picture : qc_picture;
  write_png(path_of(plan, "qc"),
            draw(result.segmentation.image, result.segmentation.objects, stem_of(result.settings)));
}

void write_convergence(const SegmentResult& result, const std::vector<PlannedFile>& plan) {
  if (!result.settings.writes("convergence")) return;
  write_png(path_of(plan, "convergence"), convergence_picture(result.segmentation.objects, stem_of(result.settings)));
}

}  // namespace pellicle
