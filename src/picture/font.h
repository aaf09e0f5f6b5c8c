#pragma once
/// A 5x7 bitmap font of printable ASCII for labels in pictures; no font file is needed.

#include <cstdint>

namespace pellicle {

constexpr int glyph_width = 5, glyph_height = 7;

/// Whether a pixel of a character is set; characters outside ASCII look like '?'.
bool glyph_pixel(char character, int column, int row);

}  // namespace pellicle
