#include "pellicle/output/segment_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "pellicle/base/atomic_file.h"
#include "pellicle/base/errors.h"
#include "pellicle/base/parallel.h"
#include "pellicle/image/reorder.h"
#include "pellicle/output/internal/segment_ends.h"
#include "pellicle/output/seed_files.h"
#include "pellicle/output/segment_report.h"

namespace pellicle {
namespace fs = std::filesystem;

namespace {

// Fractions of a run: reading and seeding before, writing after the segmentation.
constexpr double kSeeded = 0.08, kSegmentFrom = 0.1, kSegmentTo = 0.9, kWritten = 0.95;

void begin_phase(const Observer& observer, double fraction, const std::string& what) {
  observer.tell(what);
  observer.tell_progress(fraction, what);
  observer.check_stopped();
}

Volume read_input(const SegmentSettings& settings, const Observer& observer, SegmentResult& result) {
  Volume volume = read_volume(settings.input, {settings.spacing, result.frame});
  result.header = volume.header;
  result.nan_count = volume.nan_count;
  result.inf_count = volume.inf_count;
  result.min = volume.min;
  result.max = volume.max;
  result.warnings = volume.header.warnings;
  if (!(volume.max > volume.min) && !settings.wants_many()) {
    throw BadData(fmt::format("constant volume ({}): every voxel is {}; there is nothing to segment",
                              settings.input.string(), volume.min));
  }
  for (const auto& warning : result.warnings) {
    observer.tell_warning(fmt::format("{}: {}", settings.input.string(), warning));
  }
  volume.image = in_lps_order(std::move(volume.image));
  return volume;
}

/// The files that a run over these objects writes, none of which may be in the way.
template <class Objects>
std::vector<PlannedFile> files_for(const SegmentSettings& settings, const Objects& objects) {
  std::vector<int> labels;
  labels.reserve(objects.size());
  for (const auto& object : objects) labels.push_back(object.label);
  auto plan = checked_plan(settings, labels);
  if (!settings.overwrite) check_outputs(stale_outputs(settings, plan), false, {});
  return plan;
}

/// Seeds, plan and segmentation; the volume is used up. \param series null: the input is 3D.
std::vector<PlannedFile> segment_volume(Volume volume, const Observer& observer, SegmentSeries* series,
                                        PhaseClock& clock, SegmentResult& result) {
  const SegmentSettings& settings = result.settings;
  clock.start("seed");
  begin_phase(observer, kSeeded, "seeding");
  std::vector<ObjectSeed> seeds = series != nullptr ? series->carried_seeds() : std::vector<ObjectSeed>{};
  if (seeds.empty()) seeds = read_seeds(settings, result.header.grid, volume.image);
  files_for(settings, seeds);
  clock.stop();
  const SegmentOptions options = options_of(settings, result.header.grid);
  const Observer own = observer.part(kSegmentFrom, kSegmentTo);
  result.segmentation = series != nullptr ? series->next(std::move(volume.image), seeds, options, own)
                                          : segment(std::move(volume.image), seeds, options, own);
  const auto& warnings = result.segmentation.warnings;
  result.warnings.insert(result.warnings.end(), warnings.begin(), warnings.end());
  clock.add(result.segmentation.seconds);
  return files_for(settings, result.segmentation.objects);
}

SegmentResult run(const SegmentSettings& settings, std::optional<int> frame, SegmentSeries* series,
                  const RunRecord& record, const Observer& observer) {
  const ThreadLimit limit(settings.threads);
  check_before_work(settings);
  SegmentResult result;
  result.frame = frame;
  result.settings = settings;
  result.settings.fit.model.kind = settings.model_kind();
  PhaseClock clock;
  InputHashes hashes(settings);
  clock.start("read");
  begin_phase(observer, 0.0, "reading");
  Volume volume = read_input(settings, observer, result);
  std::vector<PlannedFile> plan = segment_volume(std::move(volume), observer, series, clock, result);

  clock.start("write");
  begin_phase(observer, kSegmentTo, "writing");
  write_results(result, observer, plan);
  if (settings.writes("qc")) {
    clock.start("picture");
    begin_phase(observer, kWritten, "drawing");
    write_qc(result, plan);
  }
  write_convergence(result, plan);
  clock.start("provenance");
  result.inputs = hashes.collect();
  for (const PlannedFile& file : plan) {
    if (file.kind != "report") result.outputs.push_back(described(file.kind, file.path));
  }
  clock.stop();
  result.seconds = clock.seconds();
  if (settings.writes("report")) {
    write_text_file(path_of(plan, "report"), report_of(result, record).dump(2) + "\n");
  }
  observer.tell_progress(1.0, "done");
  return result;
}

}  // namespace

// The labels as far as they are known without reading images.
void check_before_work(const SegmentSettings& settings) {
  settings.validate();
  std::error_code ignored;
  if (!fs::exists(settings.input, ignored)) {
    throw NoInput(fmt::format("no such file (`input` {}): nothing is there; check the path", settings.input.string()));
  }
  check_seed_files(settings);
  std::vector<int> labels;
  for (std::size_t i = 0; i < settings.all_seed_spheres().size(); ++i) labels.push_back(static_cast<int>(i) + 1);
  if (settings.seeds_file) {
    for (const auto& row : read_seed_table(*settings.seeds_file)) {
      labels.push_back(row.label.value_or(static_cast<int>(labels.size()) + 1));
    }
  }
  if (labels.empty() && !settings.wants_many()) labels.push_back(1);
  checked_plan(settings, labels);
  if (settings.trace) check_trace(trace_files(settings), settings.overwrite);
}

SegmentOptions options_of(const SegmentSettings& settings, const ImageGrid& grid) {
  SegmentOptions options{.fit = settings.fit,
                         .many = settings.wants_many(),
                         .radius = settings.radius,
                         .seed_rules = {.valley = settings.valley},
                         .mesh_level = settings.mesh_density,
                         .fraction_map = settings.writes("prob"),
                         .distance_map = settings.writes("sdf"),
                         .keep_image = settings.writes("qc"),
                         .map_grid = grid};
  options.fit.model.kind = settings.model_kind();
  options.fit.trace_every = settings.trace ? settings.trace_every : 0;
  return options;
}

bool SegmentResult::writes_labels() const {
  return segmentation.objects.size() > 1 || settings.wants_many();
}

int SegmentResult::exit_code() const {
  return segmentation.all_ok() ? 0 : 3;
}

SegmentResult segment_to_files(const SegmentSettings& settings, const RunRecord& record, const Observer& observer) {
  return run(settings, {}, nullptr, record, observer);
}

SegmentResult segment_frame_to_files(const SegmentSettings& settings, int frame, SegmentSeries& series,
                                     const RunRecord& record, const Observer& observer) {
  return run(settings, frame, &series, record, observer);
}

}  // namespace pellicle
