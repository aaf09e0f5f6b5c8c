#include "pellicle/picture/line_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pellicle/picture/font.h"

namespace pellicle {

namespace {

constexpr Rgb paper{255, 255, 255}, ink{40, 44, 52}, grid_color{222, 225, 230}, span_color{243, 245, 248};
constexpr int text_scale = 2, line_height = text_scale * glyph_height;

// draw_text rims its letters in black, which suits pictures; on paper they stand alone.
void write(Canvas& canvas, int x, int y, const std::string& text, Rgb color) {
  for (const char c : text) {
    for (int row = 0; row < glyph_height; ++row) {
      for (int column = 0; column < glyph_width; ++column) {
        if (!glyph_pixel(c, column, row)) continue;
        fill_rectangle(canvas, x + text_scale * column, y + text_scale * row, text_scale, text_scale, color);
      }
    }
    x += text_scale * (glyph_width + 1);
  }
}

bool fits(double value, PlotScale scale) {
  return std::isfinite(value) && (scale != PlotScale::logarithmic || value > 0.0);
}

bool drawable(const Vec2& p, const LinePlot& plot) {
  return fits(p.x(), plot.x_scale) && fits(p.y(), plot.y_scale);
}

/// An axis onto pixels.
struct Axis {
  PlotScale scale = PlotScale::logarithmic;
  double low = 1.0, high = 10.0, from = 0.0, to = 1.0;
  double at(double value) const {
    const double share =
        scale == PlotScale::logarithmic ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
    return from + (to - from) * share;
  }
  std::vector<double> ticks() const {
    if (scale == PlotScale::counts) return count_ticks(low, high, 12);
    return scale == PlotScale::linear ? linear_ticks(low, high) : log_ticks(low, high);
  }
};

void widen(double low, double high, Axis& axis) {
  if (axis.scale == PlotScale::counts) {
    axis.low = low - 0.5;
    axis.high = high + 0.5;
    return;
  }
  if (axis.scale == PlotScale::linear) {
    const double margin = high > low ? 0.05 * (high - low) : std::max(0.5 * std::abs(low), 0.5);
    axis.low = low - margin;
    axis.high = high + margin;
    return;
  }
  // A sixth of the range on both sides, and never less than a factor of two in all.
  const double margin = std::max(std::pow(high / low, 0.08), std::sqrt(2.0));
  axis.low = low / margin;
  axis.high = high * margin;
}

}  // namespace

std::vector<double> log_ticks(double low, double high) {
  std::vector<double> ticks;
  for (int power = static_cast<int>(std::floor(std::log10(low))) - 1; power <= std::ceil(std::log10(high)); ++power) {
    for (const double digit : {1.0, 2.0, 5.0}) {
      const double tick = digit * std::pow(10.0, power);
      if (tick >= low * (1.0 - 1e-9) && tick <= high * (1.0 + 1e-9)) ticks.push_back(tick);
    }
  }
  return ticks;
}

std::vector<double> count_ticks(double low, double high, int most) {
  double step = 1.0;
  for (int i = 0; (high - low) / step > most; ++i) step *= i % 3 == 1 ? 2.5 : 2.0;  // 1, 2, 5, 10, ...
  std::vector<double> ticks;
  for (double tick = std::ceil(low / step) * step; tick <= high; tick += step) ticks.push_back(tick);
  return ticks;
}

std::vector<double> linear_ticks(double low, double high) {
  const double rough = (high - low) / 5.0, power = std::pow(10.0, std::floor(std::log10(rough)));
  const double step = power * (rough < 2.0 * power ? 1.0 : rough < 5.0 * power ? 2.0 : 5.0);
  std::vector<double> ticks;
  for (double n = std::ceil(low / step - 1e-9); n * step <= high + 1e-9 * step; n += 1.0)
    ticks.push_back(n * step + 0.0);
  return ticks;
}

namespace {

void draw_spans(Canvas& canvas, const LinePlot& plot, const Axis& x, int top, int bottom) {
  bool shaded = false;
  for (const PlotSpan& span : plot.spans) {
    const int from = static_cast<int>(std::lround(x.at(span.from))), to = static_cast<int>(std::lround(x.at(span.to)));
    if (shaded) fill_rectangle(canvas, from, top, to - from, bottom - top, span_color);
    shaded = !shaded;
    draw_line(canvas, {from, top}, {from, bottom}, 1.0, grid_color);
    std::string name = span.name;
    while (!name.empty() && text_width(name, text_scale) > to - from - 6) name.pop_back();
    write(canvas, from + 4, bottom - line_height - 6, name, ink);
  }
}

}  // namespace

Canvas draw_line_plot(const LinePlot& plot, int width, int height) {
  Canvas canvas(width, height, paper);
  Axis x{.scale = plot.x_scale}, y{.scale = plot.y_scale};
  bool any = false;
  double x0 = 0.0, x1 = 0.0, y0 = 0.0, y1 = 0.0;
  for (const PlotCurve& curve : plot.curves) {
    for (const Vec2& p : curve.points) {
      if (!drawable(p, plot)) continue;
      x0 = any ? std::min(x0, p.x()) : p.x();
      x1 = any ? std::max(x1, p.x()) : p.x();
      y0 = any ? std::min(y0, p.y()) : p.y();
      y1 = any ? std::max(y1, p.y()) : p.y();
      any = true;
    }
  }
  if (any) {
    if (plot.y_scale == PlotScale::linear && y0 > 0.0) y0 = 0.0;
    widen(x0, x1, x);
    widen(y0, y1, y);
    if (plot.y_scale == PlotScale::linear && y0 == 0.0) y.low = 0.0;
  }
  const int left = 110, right = width - 30, top = 70, bottom = height - 80;
  x.from = left;
  x.to = right;
  y.from = bottom;
  y.to = top;
  draw_spans(canvas, plot, x, top, bottom);
  for (const double tick : x.ticks()) {
    const double at = x.at(tick);
    if (x.scale != PlotScale::counts) draw_line(canvas, {at, top}, {at, bottom}, 1.0, grid_color);
    const std::string text = fmt::format("{:.6g}", tick);
    write(canvas, static_cast<int>(at) - text_width(text, text_scale) / 2, bottom + 12, text, ink);
  }
  for (const double tick : y.ticks()) {
    const double at = y.at(tick);
    draw_line(canvas, {left, at}, {right, at}, 1.0, grid_color);
    const std::string text = fmt::format("{:.6g}", tick);
    write(canvas, left - 12 - text_width(text, text_scale), static_cast<int>(at) - line_height / 2, text, ink);
  }
  draw_line(canvas, {left, top}, {left, bottom}, 2.0, ink);
  draw_line(canvas, {left, bottom}, {right, bottom}, 2.0, ink);
  write(canvas, (left + right - text_width(plot.title, text_scale)) / 2, 14, plot.title, ink);
  write(canvas, 14, top - 28, plot.y_label, ink);
  write(canvas, (left + right - text_width(plot.x_label, text_scale)) / 2, height - 30, plot.x_label, ink);
  int key_y = plot.x_scale == PlotScale::counts ? top - 28 : top + 14,
      key_right = right - 14;  // in a row above a plot of many steps
  for (const PlotCurve& curve : plot.curves) {
    const Vec2* before = nullptr;
    for (const Vec2& p : curve.points) {
      if (!drawable(p, plot)) {
        before = nullptr;
        continue;
      }
      const Vec2 here(x.at(p.x()), y.at(p.y()));
      if (before != nullptr) draw_line(canvas, {x.at(before->x()), y.at(before->y())}, here, 2.5, curve.color);
      draw_line(canvas, here, here, x.scale == PlotScale::counts ? 5.0 : 9.0, curve.color);
      before = &p;
    }
    const int text_x = key_right - text_width(curve.name, text_scale);
    write(canvas, text_x, key_y, curve.name, ink);
    draw_line(canvas, {text_x - 46.0, key_y + 0.5 * line_height}, {text_x - 12.0, key_y + 0.5 * line_height}, 2.5,
              curve.color);
    if (plot.x_scale == PlotScale::counts) {
      key_right = text_x - 70;
    } else {
      key_y += line_height + 10;
    }
  }
  return canvas;
}

}  // namespace pellicle
