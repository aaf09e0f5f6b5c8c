#pragma once
/// A small picture to draw on: RGB, 8 bit, x to the right, y down, pixel centres at whole numbers.

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pellicle/base/geometry.h"

namespace pellicle {

using Rgb = std::array<std::uint8_t, 3>;
using Vec2 = Eigen::Vector2d;

struct Canvas {
  int width = 0, height = 0;
  std::vector<Rgb> pixels;  ///< row after row
  Canvas(int w, int h, Rgb background = {0, 0, 0});
  Rgb& at(int x, int y) {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  }
};

/// Mixes `color` over a pixel; outside the canvas nothing happens.
void blend(Canvas& canvas, int x, int y, Rgb color, double opacity);
/// Anti-aliased segment with round ends.
void draw_line(Canvas& canvas, const Vec2& from, const Vec2& to, double width, Rgb color);
void fill_rectangle(Canvas& canvas, int x, int y, int width, int height, Rgb color);
/// Text with a dark rim, upper left corner at (x, y); each font pixel is `scale` picture pixels.
void draw_text(Canvas& canvas, int x, int y, const std::string& text, int scale, Rgb color);
int text_width(const std::string& text, int scale);
/// Copies `part` with its upper left corner at (x, y).
void paste(Canvas& canvas, const Canvas& part, int x, int y);

/// Atomic. \throws CannotCreate, IoError.
void write_png(const std::filesystem::path& path, const Canvas& canvas);

}  // namespace pellicle
