#include <zlib.h>

#include <array>
#include <cstdint>

#include "pellicle/base/errors.h"
#include "pellicle/mesh/files/internal/mesh_formats.h"

namespace pellicle::mesh_formats {

namespace {
constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
}

std::string base64_encode(std::string_view bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (k < n ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += k <= n ? kAlphabet[group >> (18 - 6 * k) & 63U] : '=';
  }
  return text;
}

bool base64_decode(std::string_view text, std::string& bytes) {
  std::array<std::int8_t, 256> value{};
  value.fill(-1);
  for (std::size_t i = 0; i < kAlphabet.size(); ++i) {
    value[static_cast<unsigned char>(kAlphabet[i])] = static_cast<std::int8_t>(i);
  }
  bytes.clear();
  bytes.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t group = 0;
  int digits = 0, padding = 0;
  for (const char c : text) {
    if (c == ' ' || c == '\n' || c == '\r' || c == '\t') continue;
    if (c == '=') {
      ++padding;
      group <<= 6;
    } else {
      const std::int8_t v = value[static_cast<unsigned char>(c)];
      // Data after padding: VTK writes a header and its data as two padded texts in a row.
      if (v < 0 || (padding > 0 && digits != 0)) return false;
      padding = 0;
      group = group << 6 | static_cast<std::uint8_t>(v);
    }
    if (++digits < 4) continue;
    if (padding > 2) return false;
    for (int k = 0; k < 3 - padding; ++k) bytes += static_cast<char>(group >> (16 - 8 * k) & 255U);
    digits = 0;
    group = 0;
    padding = 0;
  }
  return digits == 0;
}

std::string zlib_compress(std::string_view bytes) {
  uLongf size = compressBound(bytes.size());
  std::string packed(size, '\0');
  const int status = compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                               reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), 6);
  if (status != Z_OK) throw IoError("compressing failed (mesh file): zlib is out of memory");
  packed.resize(size);
  return packed;
}

bool zlib_expand(std::string_view packed, std::size_t size, std::string& bytes) {
  // Deflate gains at most 1032 : 1, so a larger claim is wrong and nothing is allocated for it.
  if (size > packed.size() * 1040 + 64) return false;
  bytes.assign(size, '\0');
  z_stream stream{};
  if (inflateInit2(&stream, 15 + 32) != Z_OK) return false;  // zlib or gzip header
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = static_cast<uInt>(size);
  const int status = inflate(&stream, Z_FINISH);
  const bool whole = status == Z_STREAM_END && stream.avail_out == 0;
  inflateEnd(&stream);
  return whole;
}

}  // namespace pellicle::mesh_formats
