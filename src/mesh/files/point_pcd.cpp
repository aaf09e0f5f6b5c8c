// PCD of the Point Cloud Library: a text header (FIELDS, SIZE, TYPE, COUNT, WIDTH, HEIGHT, POINTS, DATA), then text,
// packed records, or columns compressed by LZF (the format of M. Lehmann's liblzf).
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <cstring>

#include "pellicle/mesh/files/internal/mesh_formats.h"
#include "pellicle/mesh/files/internal/point_formats.h"

namespace pellicle::point_formats {

namespace {

using mesh_formats::parse_number;
using mesh_formats::TextCursor;

struct Field {
  std::string name;
  std::size_t size = 4, count = 1;
  char type = 'F';
  std::size_t offset = 0;  ///< within a record
};

struct PcdHeader {
  std::vector<Field> fields;
  std::size_t points = 0, record = 0;
  std::string data;
};

std::vector<std::string_view> rest_of(TextCursor& words) {
  std::vector<std::string_view> out;
  for (auto word = words.next_word(); !word.empty(); word = words.next_word()) out.push_back(word);
  return out;
}

std::size_t count_in(const Source& source, std::string_view word, const char* key) {
  double value = -1.0;
  if (!parse_number(word, value) || !(value >= 0.0 && value < 1e12) || value != std::floor(value)) {
    fail(source, fmt::format("its {} is not a whole number", key));
  }
  return static_cast<std::size_t>(value);
}

void read_per_field(const Source& source, const std::string& key, const std::vector<std::string_view>& values,
                    PcdHeader& header) {
  if (values.size() != header.fields.size()) fail(source, fmt::format("{} does not name one value a field", key));
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (key == "TYPE") {
      header.fields[i].type = values[i][0];
    } else {
      const std::size_t value = count_in(source, values[i], key.c_str());
      if (value > 4096) fail(source, fmt::format("a {} of {} is not believable", key, value));
      (key == "SIZE" ? header.fields[i].size : header.fields[i].count) = value;
    }
  }
}

PcdHeader read_pcd_header(const Source& source, TextCursor& lines) {
  PcdHeader header;
  std::string_view line;
  std::size_t width = 0, height = 1;
  bool counted = false;
  while (lines.next_line(line)) {
    TextCursor words(line.substr(0, line.find('#')));
    const std::string key(words.next_word());
    const auto values = rest_of(words);
    if (key.empty()) continue;
    if (values.empty()) fail(source, fmt::format("'{}' in its header has no value", key.substr(0, 40)));
    if (key == "FIELDS") {
      for (const auto value : values) header.fields.push_back({std::string(value)});
    } else if (key == "SIZE" || key == "TYPE" || key == "COUNT") {
      read_per_field(source, key, values, header);
    } else if (key == "WIDTH") {
      width = count_in(source, values[0], "WIDTH");
    } else if (key == "HEIGHT") {
      height = count_in(source, values[0], "HEIGHT");
    } else if (key == "POINTS") {
      header.points = count_in(source, values[0], "POINTS");
      counted = true;
    } else if (key == "DATA") {
      header.data = values[0];
      break;
    } else if (key != "VERSION" && key != "VIEWPOINT") {
      fail(source, fmt::format("'{}' does not belong in the header of a PCD file", key.substr(0, 40)));
    }
  }
  if (!counted) header.points = width * height;
  if (header.data.empty()) fail(source, "its header has no DATA");
  for (Field& field : header.fields) {
    field.offset = header.record;
    header.record += field.size * field.count;
  }
  return header;
}

double scalar_at(const Source& source, const Field& field, const char* raw) {
  const auto as = [&]<class T>(T value) {
    std::memcpy(&value, raw, sizeof value);
    return static_cast<double>(value);
  };
  if (field.type == 'F' && field.size == 4) return as(float{});
  if (field.type == 'F' && field.size == 8) return as(double{});
  if (field.type == 'I' && field.size == 4) return as(std::int32_t{});
  if (field.type == 'I' && field.size == 2) return as(std::int16_t{});
  if (field.type == 'U' && field.size == 4) return as(std::uint32_t{});
  if (field.type == 'U' && field.size == 2) return as(std::uint16_t{});
  fail(source, fmt::format("coordinates of type {}{} are not supported", field.type, field.size));
}

bool lzf_expand(std::string_view in, std::size_t size, std::string& out) {
  out.clear();
  out.reserve(size);
  std::size_t i = 0;
  while (i < in.size()) {
    const auto control = static_cast<std::size_t>(static_cast<unsigned char>(in[i++]));
    if (control < 32) {  // a run of control + 1 literal bytes
      if (i + control + 1 > in.size()) return false;
      out.append(in.substr(i, control + 1));
      i += control + 1;
    } else {  // a copy of what came before
      std::size_t length = control >> 5;
      if (length == 7 && i < in.size()) length += static_cast<unsigned char>(in[i++]);
      if (i >= in.size()) return false;
      const std::size_t back = ((control & 31U) << 8U) + static_cast<unsigned char>(in[i++]) + 1;
      if (back > out.size()) return false;
      for (std::size_t k = 0; k < length + 2; ++k) out.push_back(out[out.size() - back]);
    }
    if (out.size() > size) return false;
  }
  return out.size() == size;
}

void add(const Source& source, const Vec3& x, PointCloud& cloud) {
  if (x.array().isNaN().any()) return;  // the format's way to say that there is none
  if (!x.allFinite()) fail(source, fmt::format("point {} is not finite", cloud.points.size()));
  cloud.points.push_back(x);
}

using Xyz = std::array<const Field*, 3>;

PointCloud read_ascii(const Source& source, const PcdHeader& header, const Xyz& xyz, TextCursor& lines) {
  std::size_t columns = 0;
  std::array<std::size_t, 3> column{};
  for (const Field& field : header.fields) {
    for (std::size_t a = 0; a < 3; ++a) {
      if (xyz[a] == &field) column[a] = columns;
    }
    columns += field.count;
  }
  PointCloud cloud;
  std::string_view line;
  std::size_t found = 0;
  while (found < header.points && lines.next_line(line)) {
    TextCursor words(line);
    const auto values = rest_of(words);
    if (values.empty()) continue;
    if (values.size() != columns) {
      fail(source, fmt::format("point {} has {} columns, {} are due", found, values.size(), columns));
    }
    Vec3 x;
    for (std::size_t a = 0; a < 3; ++a) {
      if (!parse_number(values[column[a]], x[static_cast<int>(a)])) {
        fail(source, fmt::format("point {}: '{}' is not a number", found, values[column[a]].substr(0, 40)));
      }
    }
    add(source, x, cloud);
    ++found;
  }
  if (found < header.points)
    fail(source, fmt::format("it claims {} points and holds {}; is it truncated?", header.points, found));
  return cloud;
}

// The data of binary_compressed: packed and unpacked size, then LZF.
std::string unpacked(const Source& source, std::string_view data) {
  std::uint32_t sizes[2];
  if (data.size() < sizeof sizes) fail(source, "the file ends before its data are complete");
  std::memcpy(sizes, data.data(), sizeof sizes);
  data.remove_prefix(sizeof sizes);
  if (data.size() < sizes[0]) fail(source, "the file ends before its data are complete");
  std::string expanded;
  // LZF packs at most about 1 : 90.
  if (sizes[1] / 100 > sizes[0] || !lzf_expand(data.substr(0, sizes[0]), sizes[1], expanded))
    fail(source, "its compressed data are damaged");
  return expanded;
}

/// \param by_field each field's values one after another, as in binary_compressed, else point by point.
PointCloud read_binary(const Source& source, const PcdHeader& header, const Xyz& xyz, std::string_view data,
                       bool by_field) {
  if (header.record == 0 || header.points > data.size() / header.record) {
    fail(source, fmt::format("it claims {} points, more than the file holds; is it truncated?", header.points));
  }
  PointCloud cloud;
  for (std::size_t i = 0; i < header.points; ++i) {
    Vec3 x;
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t at =
          by_field ? xyz[a]->offset * header.points + i * xyz[a]->size : i * header.record + xyz[a]->offset;
      x[static_cast<int>(a)] = scalar_at(source, *xyz[a], data.data() + at);
    }
    add(source, x, cloud);
  }
  return cloud;
}

}  // namespace

PointCloud read_pcd(const Source& source) {
  TextCursor lines(source.bytes);
  const PcdHeader header = read_pcd_header(source, lines);
  Xyz xyz{};
  for (const Field& field : header.fields) {
    for (std::size_t a = 0; a < 3; ++a) {
      if (field.name == std::string(1, "xyz"[a])) xyz[a] = &field;
    }
  }
  for (const Field* field : xyz) {
    if (field == nullptr || field->count != 1) fail(source, "its FIELDS lack x, y or z");
  }
  if (header.data == "ascii") return read_ascii(source, header, xyz, lines);
  if (header.data == "binary") return read_binary(source, header, xyz, lines.rest(), false);
  if (header.data != "binary_compressed") {
    fail(source, fmt::format("DATA {} is not supported", header.data.substr(0, 40)));
  }
  return read_binary(source, header, xyz, unpacked(source, lines.rest()), true);
}

}  // namespace pellicle::point_formats
