#include "pellicle/output/series_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "pellicle/base/atomic_file.h"
#include "pellicle/base/errors.h"
#include "pellicle/output/outputs.h"
#include "pellicle/picture/line_plot.h"

namespace pellicle {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostCurves = 6;  // more cannot be told apart

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

/// Volume against time: a curve for each object, of many their sum.
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

SeriesResult segment_series_to_files(const SegmentSettings& settings, const RunRecord& record,
                                     const Observer& observer) {
  const int frames = frames_of(settings);
  check_series(settings, frames);
  SeriesResult series;
  SegmentSeries segmentations;
  std::string unit = "frame";
  for (int frame = 0; frame < frames; ++frame) {
    Observer own = observer;
    if (observer.progress) {
      own.progress = [&](double fraction, const std::string& what) {
        observer.progress((frame + fraction) / frames, fmt::format("frame {}: {}", frame, what));
      };
    }
    const SegmentResult result =
        segment_frame_to_files(settings_of_frame(settings, frame), frame, segmentations, record, own);
    unit = result.header.frame_unit;
    for (const ObjectResult& object : result.segmentation.objects) {
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
