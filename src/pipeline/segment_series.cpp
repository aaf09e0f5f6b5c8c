#include "pellicle/pipeline/segment_series.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "pellicle/base/atomic_file.h"
#include "pellicle/base/errors.h"
#include "pellicle/pipeline/label_tracks.h"
#include "pellicle/pipeline/line_plot.h"
#include "pellicle/pipeline/outputs.h"

namespace pellicle {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostCurves = 6;  // more cannot be told apart

bool is_believable(FitStatus status) {
  return status == FitStatus::ok || status == FitStatus::doubtful || status == FitStatus::ambiguous;
}

SegmentSettings settings_of_frame(const SegmentSettings& settings, int frame) {
  SegmentSettings own = settings;
  own.name = fmt::format("{}_t{:03}", stem_of(settings), frame);
  return own;
}

fs::path series_file(const SegmentSettings& settings, const char* extension) {
  return settings.output / (stem_of(settings) + "_series" + extension);
}

std::string series_table(const SeriesResult& series, const std::string& unit) {
  std::string text = fmt::format("frame\ttime_{}\tlabel\tname\tvolume_ml\tstatus\n", unit);
  for (const SeriesRow& row : series.rows) {
    text += fmt::format("{}\t{:.6g}\t{}\t{}\t{:.6g}\t{}\n", row.frame, row.time, row.label, row.name, row.volume_ml,
                        to_string(row.status));
  }
  return text;
}

/// Volume against time: a curve an object, of many the sum.
Canvas series_plot(const SeriesResult& series, const std::string& title, const std::string& unit) {
  constexpr Rgb colors[kMostCurves] = {{31, 119, 180}, {214, 39, 40},   {44, 160, 44},
                                       {255, 127, 14}, {148, 103, 189}, {140, 86, 75}};
  std::map<int, PlotCurve> curves;
  PlotCurve all{.name = "all objects", .color = colors[0], .points = {}};
  for (const SeriesRow& row : series.rows) {
    PlotCurve& curve = curves[row.label];
    curve.name = row.name;
    curve.points.emplace_back(row.time, row.volume_ml);
    if (all.points.empty() || all.points.back().x() != row.time) all.points.emplace_back(row.time, 0.0);
    all.points.back().y() += row.volume_ml;
  }
  LinePlot plot{.title = title,
                .x_label = "time, " + unit,
                .y_label = "volume, ml",
                .curves = {},
                .x_scale = PlotScale::linear,
                .y_scale = PlotScale::linear};
  if (curves.size() > kMostCurves) {
    plot.curves.push_back(all);
  } else {
    for (auto& [label, curve] : curves) {
      curve.color = colors[plot.curves.size()];
      plot.curves.push_back(curve);
    }
  }
  return draw_line_plot(plot, 900, 640);
}

/// The objects' last believable surfaces, for the next frame.
class LastSurfaces {
 public:
  void keep(const std::vector<ObjectResult>& objects) {
    for (const ObjectResult& object : objects) {
      if (is_believable(object.fit.status))
        seeds_.insert_or_assign(object.label, ObjectSeed{object.label, object.name, {object.surface}});
    }
  }
  /// All objects or none: one without a surface yet starts as it did in the first frame, and so do then all.
  std::vector<ObjectSeed> seeds(std::size_t objects) const {
    std::vector<ObjectSeed> list;
    if (seeds_.size() < objects) return list;
    for (const auto& [label, seed] : seeds_) list.push_back(seed);
    return list;
  }

 private:
  std::map<int, ObjectSeed> seeds_;
};

void relabel(const std::map<int, int>& kept, std::vector<ObjectResult>& objects) {
  std::vector<ObjectResult> seen;
  for (ObjectResult& object : objects) {
    const auto at = kept.find(object.label);
    if (at == kept.end()) continue;  // not a voxel of it lies in the image
    object.label = at->second;
    object.name = fmt::format("object-{}", object.label);
    seen.push_back(std::move(object));
  }
  std::sort(seen.begin(), seen.end(), [](const auto& a, const auto& b) { return a.label < b.label; });
  objects = std::move(seen);
}

void check_series(const SegmentSettings& settings, int frames) {
  settings.validate();
  if (settings.points) {
    throw SettingError("expert points of which frame", "points", settings.points->string(),
                       fmt::format("the input is a series of {} frames; extract the one that they belong to", frames));
  }
  for (int frame = 0; frame < frames; ++frame) check_before_work(settings_of_frame(settings, frame));
  check_outputs({series_file(settings, ".tsv"), series_file(settings, ".png")}, settings.overwrite, {settings.input});
}

}  // namespace

int frames_of(const SegmentSettings& settings) {
  return frame_count(settings.input);
}

SeriesResult segment_series(const SegmentSettings& settings, const RunContext& context) {
  const int frames = frames_of(settings);
  check_series(settings, frames);
  const bool looked_for = settings.wants_many() && settings.all_seed_spheres().empty() && !settings.seeds_file &&
                          !settings.seed_mask && !settings.seed_model;
  SeriesResult series;
  LastSurfaces last;
  LabelTracks tracks;
  std::string unit = "frame";
  std::size_t objects = 0;
  for (int frame = 0; frame < frames; ++frame) {
    RunContext own = context;
    if (context.progress) {
      own.progress = [&](double share, const std::string& what) {
        context.progress((frame + share) / frames, fmt::format("frame {}: {}", frame, what));
      };
    }
    FrameStart start{.frame = frame};
    if (looked_for) {
      start.relabel = [&](std::vector<ObjectResult>& found, Image<std::uint16_t>& labels) {
        relabel(tracks.follow(labels), found);
      };
    } else if (frame > 0) {
      start.seeds = last.seeds(objects);
    }
    const SegmentResult result = segment_frame(settings_of_frame(settings, frame), own, start);
    unit = result.header.frame_unit;
    objects = std::max(objects, result.objects.size());
    last.keep(result.objects);
    for (const ObjectResult& object : result.objects) {
      series.rows.push_back({.frame = frame,
                             .time = frame * result.header.frame_step,
                             .label = object.label,
                             .name = object.name,
                             .volume_ml = object.volume_surface_ml,
                             .status = object.fit.status,
                             .reason = object.fit.reason,
                             .seconds = object.seconds});
    }
    series.exit_code = std::max(series.exit_code, result.exit_code());
    // Complete after every frame, so that a run that is stopped leaves a table of what there is.
    write_text_file(series_file(settings, ".tsv"), series_table(series, unit));
  }
  write_png(series_file(settings, ".png"), series_plot(series, stem_of(settings), unit));
  return series;
}

}  // namespace pellicle
