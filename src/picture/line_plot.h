#pragma once
/// Curves over two axes: logarithmic, linear, or one that counts.

#include <string>
#include <vector>

#include "pellicle/picture/canvas.h"

namespace pellicle {

struct PlotCurve {
  std::string name;
  Rgb color;
  std::vector<Vec2> points;  ///< x ascending; a point that an axis cannot hold (not finite, not positive on a
                             ///< logarithmic one) interrupts
};

/// A part of the x axis with a name of its own, shaded in turns.
struct PlotSpan {
  std::string name;
  double from = 0.0, to = 0.0;
};

enum class PlotScale { logarithmic, linear, counts };  ///< counts: linear, of whole numbers

struct LinePlot {
  std::string title, x_label, y_label;
  std::vector<PlotCurve> curves;
  PlotScale x_scale = PlotScale::logarithmic, y_scale = PlotScale::logarithmic;
  std::vector<PlotSpan> spans = {};  ///< ascending
};

/// Axes with ticks (log_ticks, linear_ticks), grid lines, a key. A linear y axis starts at 0 when nothing is negative.
Canvas draw_line_plot(const LinePlot& plot, int width, int height);

/// 1, 2 and 5 times powers of ten within [low, high]. \pre 0 < low <= high.
std::vector<double> log_ticks(double low, double high);
/// At most `most` whole numbers in [low, high] at equal distances of 1, 2 or 5 times a power of ten.
std::vector<double> count_ticks(double low, double high, int most);
/// Multiples of 1, 2 or 5 times a power of ten within [low, high]: 4 to 10 of them. \pre low < high.
std::vector<double> linear_ticks(double low, double high);

}  // namespace pellicle
