// Stanford PLY: a text header that declares elements and their properties, then ascii or binary data.
// G. Turk, "The PLY Polygon File Format", 1994.
#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>

#include "pellicle/mesh/files/internal/mesh_formats.h"

namespace pellicle::mesh_formats {

namespace {

enum class Scalar { i8, u8, i16, u16, i32, u32, f32, f64 };
enum class Encoding { ascii, little, big };

struct Property {
  std::string name;
  Scalar type = Scalar::f32;
  std::optional<Scalar> count;  ///< set for lists
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

struct PlyHeader {
  Encoding encoding = Encoding::ascii;
  bool ras = false;
  std::vector<Element> elements;
};

std::size_t size_of(Scalar type) {
  switch (type) {
    case Scalar::i8:
    case Scalar::u8:
      return 1;
    case Scalar::i16:
    case Scalar::u16:
      return 2;
    case Scalar::f64:
      return 8;
    default:
      return 4;
  }
}

Scalar scalar_named(const Source& source, std::string_view word) {
  if (word == "char" || word == "int8") return Scalar::i8;
  if (word == "uchar" || word == "uint8") return Scalar::u8;
  if (word == "short" || word == "int16") return Scalar::i16;
  if (word == "ushort" || word == "uint16") return Scalar::u16;
  if (word == "int" || word == "int32") return Scalar::i32;
  if (word == "uint" || word == "uint32") return Scalar::u32;
  if (word == "float" || word == "float32") return Scalar::f32;
  if (word == "double" || word == "float64") return Scalar::f64;
  fail(source, fmt::format("'{}' is not a PLY type", word));
}

// Values one after the other, whatever the encoding.
class Values {
 public:
  Values(const Source& source, Encoding encoding, std::string_view data)
      : source_(source), encoding_(encoding), text_(data), data_(data) {}

  double next(Scalar type) {
    if (encoding_ == Encoding::ascii) {
      double value = 0.0;
      const std::string_view word = text_.next_word();
      if (word.empty()) fail(source_, "the file ends before its data are complete");
      if (!parse_number(word, value)) fail(source_, fmt::format("'{}' is not a number", word.substr(0, 40)));
      return value;
    }
    const std::size_t size = size_of(type);
    if (data_.size() < size) fail(source_, "the file ends before its data are complete");
    char raw[8];
    const bool swap = (encoding_ == Encoding::little) != (std::endian::native == std::endian::little);
    for (std::size_t i = 0; i < size; ++i) raw[i] = data_[swap ? size - 1 - i : i];
    data_.remove_prefix(size);
    switch (type) {
      case Scalar::i8:
        return as<std::int8_t>(raw);
      case Scalar::u8:
        return as<std::uint8_t>(raw);
      case Scalar::i16:
        return as<std::int16_t>(raw);
      case Scalar::u16:
        return as<std::uint16_t>(raw);
      case Scalar::i32:
        return as<std::int32_t>(raw);
      case Scalar::u32:
        return as<std::uint32_t>(raw);
      case Scalar::f32:
        return static_cast<double>(as<float>(raw));
      case Scalar::f64:
        return as<double>(raw);
    }
    return 0.0;
  }

  std::size_t left() const { return encoding_ == Encoding::ascii ? text_.rest().size() : data_.size(); }
  /// Fewest bytes that one value can take.
  std::size_t least(Scalar type) const { return encoding_ == Encoding::ascii ? 2 : size_of(type); }

 private:
  template <class T>
  static T as(const char* raw) {
    T value;
    std::memcpy(&value, raw, sizeof value);
    return value;
  }

  const Source& source_;
  Encoding encoding_;
  TextCursor text_;
  std::string_view data_;
};

void add_property(const Source& source, TextCursor& words, PlyHeader& header) {
  if (header.elements.empty()) fail(source, "a property comes before any element");
  Property property;
  std::string_view word = words.next_word();
  if (word == "list") {
    property.count = scalar_named(source, words.next_word());
    word = words.next_word();
  }
  property.type = scalar_named(source, word);
  property.name = words.next_word();
  header.elements.back().properties.push_back(property);
}

PlyHeader read_header(const Source& source, TextCursor& lines) {
  PlyHeader header;
  std::string_view line;
  if (!lines.next_line(line) || line.substr(0, 3) != "ply") fail(source, "it does not start with 'ply'");
  bool format_seen = false;
  while (lines.next_line(line)) {
    TextCursor words(line);
    const std::string_view key = words.next_word();
    if (key == "end_header") {
      if (!format_seen) fail(source, "its header names no format");
      return header;
    }
    if (key == "comment" || key == "obj_info") {
      if (line.find("SPACE=RAS") != std::string_view::npos) header.ras = true;
    } else if (key == "format") {
      const std::string_view name = words.next_word();
      if (name != "ascii" && name != "binary_little_endian" && name != "binary_big_endian") {
        fail(source, fmt::format("'{}' is not a PLY encoding", name));
      }
      header.encoding = name == "ascii"                  ? Encoding::ascii
                        : name == "binary_little_endian" ? Encoding::little
                                                         : Encoding::big;
      format_seen = true;
    } else if (key == "element") {
      Element element;
      element.name = words.next_word();
      double count = -1.0;
      if (!parse_number(words.next_word(), count) || !(count >= 0.0 && count < 2147483648.0)) {
        fail(source, fmt::format("element '{}' has no valid count", element.name));
      }
      element.count = static_cast<std::size_t>(count);
      header.elements.push_back(element);
    } else if (key == "property") {
      add_property(source, words, header);
    } else if (!key.empty()) {
      fail(source, fmt::format("its header holds '{}', which PLY does not know", key.substr(0, 40)));
    }
  }
  fail(source, "its header does not end");
}

int coordinate_of(const std::string& name) {
  constexpr std::string_view kNames[] = {"x", "y", "z", "nx", "ny", "nz"};
  for (int i = 0; i < 6; ++i) {
    if (name == kNames[i]) return i;
  }
  return -1;
}

// 1, or the length of the list that follows, once it is known to fit in what is left of the file.
std::size_t length_of(const Source& source, const Property& p, Values& values) {
  if (!p.count) return 1;
  const double count = values.next(*p.count);
  if (!(count >= 0.0 && count * static_cast<double>(values.least(p.type)) <= static_cast<double>(values.left() + 1))) {
    fail(source, fmt::format("a list claims {} values, more than the file holds", count));
  }
  return static_cast<std::size_t>(count);
}

void skip_property(const Source& source, const Property& p, Values& values) {
  for (std::size_t n = length_of(source, p, values); n > 0; --n) values.next(p.type);
}

void read_vertices(const Source& source, const Element& element, Values& values, TriangleMesh& mesh) {
  bool normals[3] = {false, false, false};
  for (const Property& p : element.properties) {
    const int c = p.count ? -1 : coordinate_of(p.name);
    if (c >= 3) normals[c - 3] = true;
  }
  const bool with_normals = normals[0] && normals[1] && normals[2];
  mesh.vertices.assign(element.count, Vec3::Zero());
  if (with_normals) mesh.normals.assign(element.count, Vec3::Zero());
  for (std::size_t v = 0; v < element.count; ++v) {
    for (const Property& p : element.properties) {
      if (p.count) {
        skip_property(source, p, values);
        continue;
      }
      const double value = values.next(p.type);
      const int c = coordinate_of(p.name);
      if (c >= 0 && c < 3) mesh.vertices[v][c] = value;
      if (c >= 3 && with_normals) mesh.normals[v][c - 3] = value;
    }
  }
}

void read_faces(const Source& source, const Element& element, Values& values, TriangleMesh& mesh) {
  std::vector<int> polygon;
  for (std::size_t f = 0; f < element.count; ++f) {
    for (const Property& p : element.properties) {
      const bool indices = p.count && (p.name == "vertex_indices" || p.name == "vertex_index");
      const std::size_t count = length_of(source, p, values);
      polygon.clear();
      for (std::size_t i = 0; i < count; ++i) {
        const double value = values.next(p.type);
        if (indices) polygon.push_back(checked_index(source, value, mesh.vertices.size()));
      }
      if (indices) add_fan(mesh, polygon);
    }
  }
}

template <class T>
void append(std::string& out, T value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof value);
  if constexpr (std::endian::native == std::endian::big) std::reverse(raw, raw + sizeof value);
  out.append(raw, sizeof value);
}

}  // namespace

TriangleMesh read_ply(const Source& source) {
  TextCursor lines(source.bytes);
  const PlyHeader header = read_header(source, lines);
  Values values(source, header.encoding, lines.rest());
  TriangleMesh mesh;
  for (const Element& element : header.elements) {
    std::size_t least = 0;
    bool xyz[3] = {false, false, false};
    for (const Property& p : element.properties) {
      least += values.least(p.count.value_or(p.type));
      const int c = p.count ? -1 : coordinate_of(p.name);
      if (c >= 0 && c < 3) xyz[c] = true;
    }
    if (element.count * least > values.left() + 1) {  // + 1: the last line of a text may lack its end
      fail(source, fmt::format("it claims {} of '{}', more than the file holds", element.count, element.name));
    }
    if (element.name == "vertex") {
      if (!xyz[0] || !xyz[1] || !xyz[2]) fail(source, "its vertices lack x, y or z");
      read_vertices(source, element, values, mesh);
    } else if (element.count > 0 && !element.properties.empty()) {
      const Element named = element.name == "face" ? element : Element{"", element.count, element.properties};
      if (named.name.empty()) {
        for (std::size_t i = 0; i < named.count; ++i) {
          for (const Property& p : named.properties) {
            skip_property(source, p, values);
          }
        }
      } else {
        read_faces(source, named, values, mesh);
      }
    }
  }
  if (header.ras) flip_lps_ras(mesh);
  return mesh;
}

std::string write_ply(const TriangleMesh& mesh) {
  const bool normals = !mesh.normals.empty();
  std::string out = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment SPACE=LPS\nelement vertex {}\n"
      "property double x\nproperty double y\nproperty double z\n{}element face {}\n"
      "property list uchar int vertex_indices\nend_header\n",
      mesh.vertices.size(), normals ? "property double nx\nproperty double ny\nproperty double nz\n" : "",
      mesh.triangles.size());
  out.reserve(out.size() + mesh.vertices.size() * (normals ? 48 : 24) + mesh.triangles.size() * 13);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    for (int a = 0; a < 3; ++a) append(out, mesh.vertices[v][a]);
    for (int a = 0; normals && a < 3; ++a) append(out, mesh.normals[v][a]);
  }
  for (const auto& t : mesh.triangles) {
    append(out, std::uint8_t{3});
    for (const int i : t) append(out, static_cast<std::int32_t>(i));
  }
  return out;
}

}  // namespace pellicle::mesh_formats
