#pragma once
/// Curves over two logarithmic axes.

#include <string>
#include <vector>

#include "pellicle/pipeline/canvas.h"

namespace pellicle {

struct PlotCurve {
  std::string name;
  Rgb color;
  std::vector<Vec2> points;  ///< x ascending; only points with positive, finite x and y are drawn
};

struct LogPlot {
  std::string title, x_label, y_label;
  std::vector<PlotCurve> curves;
};

/// Axes with ticks at 1, 2, 5 times powers of ten, grid lines, a key.
Canvas draw_log_plot(const LogPlot& plot, int width, int height);

/// 1, 2 and 5 times powers of ten within [low, high]. \pre 0 < low <= high.
std::vector<double> log_ticks(double low, double high);

}  // namespace pellicle
