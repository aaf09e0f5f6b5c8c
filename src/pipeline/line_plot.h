#pragma once
/// Curves over two axes, both logarithmic or both linear.

#include <string>
#include <vector>

#include "pellicle/pipeline/canvas.h"

namespace pellicle {

struct PlotCurve {
  std::string name;
  Rgb color;
  std::vector<Vec2> points;  ///< x ascending; only finite points are drawn, on logarithmic axes only positive ones
};

enum class PlotScale { logarithmic, linear };

struct LinePlot {
  std::string title, x_label, y_label;
  std::vector<PlotCurve> curves;
  PlotScale scale = PlotScale::logarithmic;
};

/// Axes with ticks (log_ticks, linear_ticks), grid lines, a key. A linear y axis starts at 0 when nothing is negative.
Canvas draw_line_plot(const LinePlot& plot, int width, int height);

/// 1, 2 and 5 times powers of ten within [low, high]. \pre 0 < low <= high.
std::vector<double> log_ticks(double low, double high);
/// Multiples of 1, 2 or 5 times a power of ten within [low, high]: 4 to 10 of them. \pre low < high.
std::vector<double> linear_ticks(double low, double high);

}  // namespace pellicle
