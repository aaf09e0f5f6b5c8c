#include "pellicle/output/convergence_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>

namespace pellicle {

namespace {

constexpr std::size_t kMostPlots = 8;
constexpr int kPlotWidth = 1200, kPlotHeight = 560;
// Colours that colour-blind people tell apart (Okabe and Ito); black is the sum's.
constexpr std::array<Rgb, 7> kCurveColors{
    {{0, 114, 178}, {230, 159, 0}, {0, 158, 115}, {204, 121, 167}, {213, 94, 0}, {86, 180, 233}, {150, 140, 0}}};

}  // namespace

LinePlot convergence_of(const FitSummary& fit, const std::string& title) {
  LinePlot plot{
      .title = title, .x_label = "step", .y_label = "energy (mm^2)", .curves = {}, .x_scale = PlotScale::counts};
  std::map<std::string, std::vector<Vec2>> curves;
  std::vector<Vec2> total;
  for (const StageSummary& stage : fit.stages) {
    for (const auto& step : stage.history) {
      for (const auto& [name, value] : step.energies) curves[name];
    }
  }
  const double gap = std::numeric_limits<double>::quiet_NaN();
  double at = 0.0;
  for (const StageSummary& stage : fit.stages) {
    if (stage.history.empty()) continue;
    plot.spans.push_back({stage.name, at + 0.5, at + 0.5 + static_cast<double>(stage.history.size())});
    for (auto& [name, points] : curves) points.emplace_back(at + 0.5, gap);
    total.emplace_back(at + 0.5, gap);
    for (const StepSummary& step : stage.history) {
      at += 1.0;
      double sum = 0.0;
      for (auto& [name, points] : curves) {
        const auto found = step.energies.find(name);
        points.emplace_back(at, found == step.energies.end() ? gap : found->second);
        if (found != step.energies.end()) sum += found->second;
      }
      total.emplace_back(at, sum);
    }
  }
  plot.curves.push_back({"sum", {40, 44, 52}, total});
  std::size_t color = 0;
  for (auto& [name, points] : curves) {
    plot.curves.push_back({name, kCurveColors[color++ % kCurveColors.size()], std::move(points)});
  }
  return plot;
}

Canvas convergence_picture(const std::vector<ObjectResult>& objects, const std::string& name) {
  const std::size_t count = std::min(objects.size(), kMostPlots);
  Canvas canvas(kPlotWidth, kPlotHeight * static_cast<int>(std::max<std::size_t>(1, count)), {255, 255, 255});
  for (std::size_t i = 0; i < count; ++i) {
    std::string title = objects.size() == 1 ? name : fmt::format("{}: {}", name, objects[i].name);
    if (i == 0 && objects.size() > count) title += fmt::format(" (the first {} of {})", count, objects.size());
    paste(canvas, draw_line_plot(convergence_of(objects[i].fit, title), kPlotWidth, kPlotHeight), 0,
          kPlotHeight * static_cast<int>(i));
  }
  return canvas;
}

}  // namespace pellicle
