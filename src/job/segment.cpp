#include "pellicle/job/segment.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "pellicle/base/errors.h"
#include "pellicle/image/reorder.h"
#include "pellicle/job/internal/fit_objects.h"
#include "pellicle/job/label_map.h"
#include "pellicle/job/label_tracks.h"
#include "pellicle/job/measure.h"
#include "pellicle/job/seeds.h"

namespace pellicle {

namespace {

// Of the whole: what the fits take, and from where on the measuring goes.
constexpr double kFitted = 0.875, kFittedMany = 0.75;

void begin_phase(const Observer& observer, double fraction, const std::string& what) {
  observer.tell(what);
  observer.tell_progress(fraction, what);
  observer.check_stopped();
}

bool is_constant(const Image<float>& image) {
  return std::all_of(image.voxels.begin(), image.voxels.end(), [&](float v) { return v == image.voxels.front(); });
}

// Two seeds in one object give two surfaces of it. Giving each voxel to one of them would hide that.
void tell_overlaps(const Observer& observer, double voxel_volume, Segmentation& result) {
  for (ObjectResult& object : result.objects) {
    const double own = object.volume_mask_ml * 1000.0 / voxel_volume;
    const auto shared = static_cast<double>(object.overlap_voxels);
    // What was claimed: the voxels that it kept, and at most all of the shared ones beside them.
    if (!(shared > 0.05 * std::max(own, shared))) continue;
    result.warnings.push_back(
        fmt::format("{}: other objects claim {} of its voxels too; each went to the surface in which it is deepest",
                    object.name, object.overlap_voxels));
    observer.tell_warning(result.warnings.back());
    if (shared > own && object.fit.status == FitStatus::ok) {
      object.fit.status = FitStatus::ambiguous;
      object.fit.reason = "most of it is claimed by other objects too: do two seeds lie in one object?";
    }
  }
}

/// Labels and names by what followed from the last frame; objects that have no voxel in the image are dropped.
void relabel(const std::map<int, int>& kept, std::vector<ObjectResult>& objects) {
  std::vector<ObjectResult> seen;
  for (ObjectResult& object : objects) {
    const auto at = kept.find(object.label);
    if (at == kept.end()) continue;
    object.label = at->second;
    object.name = fmt::format("object-{}", object.label);
    seen.push_back(std::move(object));
  }
  std::sort(seen.begin(), seen.end(), [](const auto& a, const auto& b) { return a.label < b.label; });
  objects = std::move(seen);
}

void fit(Image<float> image, const std::vector<ObjectSeed>& seeds, const SegmentOptions& options,
         const Observer& observer, Segmentation& result) {
  if (options.many) {
    if (options.keep_image) result.image = image;
    fit_many_objects(std::move(image), numbered(seeds), options, observer.part(0.0, kFittedMany), result);
    return;
  }
  const Observer own = observer.part(0.0, kFitted);
  if (seeds.empty()) {
    ObjectSeed found = find_object(image, options.fit);
    if (found.candidates.empty()) throw BadData("nothing found (image): it shows no object; give a seed");
    fit_objects(image, numbered({std::move(found)}), options, own, result);
  } else {
    fit_objects(image, numbered(seeds), options, own, result);
  }
  if (options.keep_image) result.image = std::move(image);
}

/// \param tracks of a time series whose objects are looked for anew in each frame; else null.
Segmentation run(Image<float> image, const std::vector<ObjectSeed>& seeds, const SegmentOptions& options,
                 const Observer& observer, LabelTracks* tracks) {
  if (image.voxels.empty()) throw BadData("empty volume (image): it has no voxel");
  const ImageGrid grid = options.map_grid.value_or(image.grid);
  Segmentation result;
  PhaseClock clock;
  clock.start("fit");
  begin_phase(observer, 0.0, "fitting");
  if (!options.many && is_constant(image)) {
    throw BadData(
        fmt::format("constant volume (image): every voxel is {}; there is nothing to segment", image.voxels.front()));
  }
  // Fits see one storage order only; the maps go on the grid as it was given.
  fit(in_lps_order(std::move(image)), seeds, options, observer, result);

  clock.start("measure");
  begin_phase(observer, kFitted, "measuring");
  measure(result.objects, grid, options);
  if (!options.many) clock.start("rasterise");
  VoxelMaps maps = label_map(result.objects, grid, options);
  result.labels = std::move(maps.labels);
  result.fraction = std::move(maps.fraction);
  if (result.many) result.many->z_extent = z_extent(result.objects);
  if (tracks != nullptr) relabel(tracks->follow(result.labels), result.objects);
  if (options.distance_map) result.distance = distance_map(result.objects, grid, options);
  if (!options.many) tell_overlaps(observer, grid.voxel_volume(), result);
  clock.stop();
  result.seconds = clock.seconds();
  return result;
}

bool is_believable(FitStatus status) {
  return status == FitStatus::ok || status == FitStatus::doubtful || status == FitStatus::ambiguous;
}

}  // namespace

ManySettings many_settings(const SegmentOptions& options) {
  return {options.fit, options.radius, options.seed_rules};
}

bool Segmentation::all_ok() const {
  return std::all_of(objects.begin(), objects.end(),
                     [](const ObjectResult& object) { return object.fit.status == FitStatus::ok; });
}

Segmentation segment(Image<float> image, const std::vector<ObjectSeed>& seeds, const SegmentOptions& options,
                     const Observer& observer) {
  return run(std::move(image), seeds, options, observer, nullptr);
}

struct SegmentSeries::State {
  std::map<int, ObjectSeed> last;  ///< by label, the last believable surface
  std::size_t objects = 0;         ///< the most that a frame had
  bool looked_for = false;
  LabelTracks tracks;
};

SegmentSeries::SegmentSeries() : state_(std::make_unique<State>()) {}
SegmentSeries::~SegmentSeries() = default;

std::vector<ObjectSeed> SegmentSeries::carried_seeds() const {
  std::vector<ObjectSeed> seeds;
  // All objects or none: when one has no surface yet, all start as they did in the first frame.
  if (state_->looked_for || state_->last.size() < state_->objects) return seeds;
  for (const auto& [label, seed] : state_->last) seeds.push_back(seed);
  return seeds;
}

Segmentation SegmentSeries::next(Image<float> frame, const std::vector<ObjectSeed>& seeds,
                                 const SegmentOptions& options, const Observer& observer) {
  state_->looked_for = options.many && seeds.empty();
  Segmentation result = run(std::move(frame), seeds, options, observer, state_->looked_for ? &state_->tracks : nullptr);
  state_->objects = std::max(state_->objects, result.objects.size());
  for (const ObjectResult& object : result.objects) {
    if (!is_believable(object.fit.status)) continue;
    state_->last.insert_or_assign(object.label,
                                  ObjectSeed{object.label, object.name, {object.surface}, ExpertPoints{}});
  }
  return result;
}

}  // namespace pellicle
