#pragma once
/// Curves over a logarithmic axis, the other one logarithmic or by steps.

#include <string>
#include <vector>

#include "pellicle/pipeline/canvas.h"

namespace pellicle {

struct PlotCurve {
  std::string name;
  Rgb color;
  std::vector<Vec2> points;  ///< x ascending; a point without positive, finite x and y interrupts the curve
};

/// A part of the x axis with a name of its own, shaded in turns.
struct PlotSpan {
  std::string name;
  double from = 0.0, to = 0.0;
};

struct LogPlot {
  std::string title, x_label, y_label;
  std::vector<PlotCurve> curves;
  bool x_counts = false;             ///< x holds whole numbers on a linear axis
  std::vector<PlotSpan> spans = {};  ///< ascending
};

/// Axes with ticks at 1, 2, 5 times powers of ten, grid lines, a key.
Canvas draw_log_plot(const LogPlot& plot, int width, int height);

/// 1, 2 and 5 times powers of ten within [low, high]. \pre 0 < low <= high.
std::vector<double> log_ticks(double low, double high);
/// At most `most` whole numbers in [low, high] at equal distances of 1, 2 or 5 times a power of ten.
std::vector<double> count_ticks(double low, double high, int most);

}  // namespace pellicle
