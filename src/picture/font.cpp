#include "pellicle/picture/font.h"

#include <array>

namespace pellicle {

namespace {

// Printable ASCII from the space on. 35 bits a glyph: 7 rows of 5 from top to bottom, the leftmost column highest.
constexpr std::array<std::uint64_t, 95> glyphs{
    0x000000000, 0x108421004, 0x294000000, 0x295f57d4a, 0x11f4717c4, 0x672222273, 0x32526564d, 0x108000000, 0x088842082,
    0x208210888, 0x009575480, 0x0084f9080, 0x000001888, 0x0000f8000, 0x00000018c, 0x042222210, 0x3a33ae62e, 0x11842108e,
    0x3a211111f, 0x7c441062e, 0x08ca97c42, 0x7e1e0862e, 0x1910f462e, 0x7c2222108, 0x3a317462e, 0x3a317844c, 0x018c03180,
    0x018c03088, 0x088882082, 0x001f07c00, 0x208208888, 0x3a2111004, 0x3a37ade0f, 0x3a31fc631, 0x7a31f463e, 0x3a308422e,
    0x7a318c63e, 0x7e10f421f, 0x7e10f4210, 0x3a30bc62f, 0x4631fc631, 0x38842108e, 0x1c4210a4c, 0x4654c5251, 0x42108421f,
    0x4775ac631, 0x4639ace31, 0x3a318c62e, 0x7a31f4210, 0x3a318d64d, 0x7a31f5251, 0x3e107043e, 0x7c8421084, 0x46318c62e,
    0x46318c544, 0x4631ad771, 0x462a22a31, 0x462a21084, 0x7c222221f, 0x39084210e, 0x420820821, 0x38421084e, 0x115100000,
    0x00000001f, 0x208000000, 0x000e0be2f, 0x421e8c63e, 0x000f8420f, 0x042f8c62f, 0x000e8fe0e, 0x1928e2108, 0x01f18bc2e,
    0x421e8c631, 0x100c2108e, 0x080610a4c, 0x4212a6292, 0x30842108e, 0x001aad6b5, 0x001e8c631, 0x000e8c62e, 0x03d18fa10,
    0x01f18bc21, 0x0016cc210, 0x000f8383e, 0x211e42126, 0x00118c66d, 0x00118c544, 0x00118d6aa, 0x001151151, 0x02318bc2e,
    0x001f1111f, 0x088441082, 0x108421084, 0x208411088, 0x0009ac800};

}  // namespace

bool glyph_pixel(char character, int column, int row) {
  const int code = static_cast<unsigned char>(character);
  const std::size_t index = code >= 32 && code < 127 ? static_cast<std::size_t>(code - 32) : '?' - 32;
  if (column < 0 || column >= glyph_width || row < 0 || row >= glyph_height) return false;
  return ((glyphs[index] >> (glyph_width * (glyph_height - row) - 1 - column)) & 1U) != 0;
}

}  // namespace pellicle
