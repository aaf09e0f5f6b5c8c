#include "pellicle/picture/canvas.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <cmath>

#include "pellicle/base/atomic_file.h"
#include "pellicle/base/errors.h"
#include "pellicle/picture/font.h"

namespace pellicle {

Canvas::Canvas(int w, int h, Rgb background)
    : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), background) {}

void blend(Canvas& canvas, int x, int y, Rgb color, double opacity) {
  if (x < 0 || y < 0 || x >= canvas.width || y >= canvas.height) return;
  Rgb& pixel = canvas.at(x, y);
  for (std::size_t c = 0; c < 3; ++c) {
    pixel[c] = static_cast<std::uint8_t>(std::lround(pixel[c] + opacity * (color[c] - pixel[c])));
  }
}

void draw_line(Canvas& canvas, const Vec2& from, const Vec2& to, double width, Rgb color) {
  const double reach = 0.5 * width + 1.0;
  const auto low = [&](int axis) { return static_cast<int>(std::floor(std::min(from[axis], to[axis]) - reach)); };
  const auto high = [&](int axis) { return static_cast<int>(std::ceil(std::max(from[axis], to[axis]) + reach)); };
  const Vec2 along = to - from;
  const double length2 = along.squaredNorm();
  for (int y = std::max(0, low(1)); y <= std::min(canvas.height - 1, high(1)); ++y) {
    for (int x = std::max(0, low(0)); x <= std::min(canvas.width - 1, high(0)); ++x) {
      const Vec2 offset = Vec2(x, y) - from;
      const double t = length2 > 0.0 ? std::clamp(offset.dot(along) / length2, 0.0, 1.0) : 0.0;
      const double distance = (offset - t * along).norm();
      const double cover = std::clamp(0.5 * width + 0.5 - distance, 0.0, 1.0);
      if (cover > 0.0) blend(canvas, x, y, color, cover);
    }
  }
}

void fill_rectangle(Canvas& canvas, int x, int y, int width, int height, Rgb color) {
  for (int row = y; row < y + height; ++row) {
    for (int column = x; column < x + width; ++column) blend(canvas, column, row, color, 1.0);
  }
}

namespace {

void draw_glyphs(Canvas& canvas, int x, int y, const std::string& text, int scale, Rgb color, int rim) {
  for (const char character : text) {
    for (int row = 0; row < glyph_height; ++row) {
      for (int column = 0; column < glyph_width; ++column) {
        if (!glyph_pixel(character, column, row)) continue;
        fill_rectangle(canvas, x + scale * column - rim, y + scale * row - rim, scale + 2 * rim, scale + 2 * rim,
                       color);
      }
    }
    x += scale * (glyph_width + 1);
  }
}

}  // namespace

void draw_text(Canvas& canvas, int x, int y, const std::string& text, int scale, Rgb color) {
  draw_glyphs(canvas, x, y, text, scale, {0, 0, 0}, 1);
  draw_glyphs(canvas, x, y, text, scale, color, 0);
}

int text_width(const std::string& text, int scale) {
  return text.empty() ? 0 : scale * (static_cast<int>(text.size()) * (glyph_width + 1) - 1);
}

void paste(Canvas& canvas, const Canvas& part, int x, int y) {
  for (int row = 0; row < part.height; ++row) {
    for (int column = 0; column < part.width; ++column) {
      const auto at =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(part.width) + static_cast<std::size_t>(column);
      blend(canvas, x + column, y + row, part.pixels[at], 1.0);
    }
  }
}

void write_png(const std::filesystem::path& path, const Canvas& canvas) {
  AtomicFile file(path);
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(canvas.width);
  image.height = static_cast<png_uint_32>(canvas.height);
  image.format = PNG_FORMAT_RGB;
  if (png_image_write_to_file(&image, file.path().c_str(), 0, canvas.pixels.data(), 3 * canvas.width, nullptr) == 0) {
    throw IoError(fmt::format("writing failed ({}): {}; is the disk full?", path.string(), image.message));
  }
  file.commit();
}

}  // namespace pellicle
