// VTK PolyData XML (.vtp; VTK file formats, "XML file formats") and GIfTI surfaces (.surf.gii; GIfTI format
// specification 1.0, 2011).
#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <pugixml.hpp>
#include <sstream>

#include "pellicle/mesh/files/internal/mesh_formats.h"

namespace pellicle::mesh_formats {

namespace {

pugi::xml_document parse_xml(const Source& source) {
  pugi::xml_document document;
  const pugi::xml_parse_result result = document.load_buffer(source.bytes.data(), source.bytes.size());
  if (!result) fail(source, fmt::format("its XML is broken at byte {}: {}", result.offset, result.description()));
  return document;
}

std::string to_text(const pugi::xml_document& document) {
  std::ostringstream out;
  document.save(out, " ", pugi::format_indent, pugi::encoding_utf8);
  return out.str();
}

template <class T>
double value_at(std::string_view bytes, std::size_t i, bool swap) {
  char raw[sizeof(T)];
  for (std::size_t k = 0; k < sizeof(T); ++k) raw[k] = bytes[i * sizeof(T) + (swap ? sizeof(T) - 1 - k : k)];
  T value;
  std::memcpy(&value, raw, sizeof value);
  return static_cast<double>(value);
}

// Both formats name their types with a kind and a number of bits.
std::vector<double> numbers_from(const Source& source, std::string_view bytes, std::string_view type, bool big_endian) {
  const bool swap = big_endian != (std::endian::native == std::endian::big);
  std::vector<double> out;
  const auto read = [&]<class T>(T) {
    if (bytes.size() % sizeof(T) != 0) fail(source, fmt::format("an array of {} ends within a value", type));
    out.resize(bytes.size() / sizeof(T));
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = value_at<T>(bytes, i, swap);
  };
  if (type == "Float32" || type == "NIFTI_TYPE_FLOAT32")
    read(float{});
  else if (type == "Float64" || type == "NIFTI_TYPE_FLOAT64")
    read(double{});
  else if (type == "Int32" || type == "NIFTI_TYPE_INT32")
    read(std::int32_t{});
  else if (type == "UInt32" || type == "NIFTI_TYPE_UINT32")
    read(std::uint32_t{});
  else if (type == "Int64" || type == "NIFTI_TYPE_INT64")
    read(std::int64_t{});
  else if (type == "UInt64" || type == "NIFTI_TYPE_UINT64")
    read(std::uint64_t{});
  else if (type == "UInt8" || type == "NIFTI_TYPE_UINT8")
    read(std::uint8_t{});
  else if (type == "Int16" || type == "NIFTI_TYPE_INT16")
    read(std::int16_t{});
  else
    fail(source, fmt::format("an array has the type '{}', which is not supported", type.substr(0, 40)));
  return out;
}

std::vector<double> numbers_from_text(const Source& source, std::string_view text) {
  std::vector<double> out;
  TextCursor words(text);
  for (std::string_view word = words.next_word(); !word.empty(); word = words.next_word()) {
    double value = 0.0;
    if (!parse_number(word, value)) fail(source, fmt::format("'{}' is not a number", word.substr(0, 40)));
    out.push_back(value);
  }
  return out;
}

struct VtkFile {
  bool big_endian, header64, compressed;
};

// [size][data], or with compression [blocks][block size][last block size][packed sizes ...] and then the blocks.
std::string vtk_payload(const Source& source, std::string_view text, const VtkFile& file) {
  std::string bytes;
  if (!base64_decode(text, bytes)) fail(source, "an array is not valid base64");
  const std::size_t word = file.header64 ? 8 : 4;
  const bool swap = file.big_endian != (std::endian::native == std::endian::big);
  const auto header = [&](std::size_t i) -> std::size_t {
    if ((i + 1) * word > bytes.size()) fail(source, "an array is shorter than its header");
    return file.header64 ? static_cast<std::size_t>(value_at<std::uint64_t>(bytes, i, swap))
                         : static_cast<std::size_t>(value_at<std::uint32_t>(bytes, i, swap));
  };
  if (!file.compressed) {
    if (bytes.empty()) return {};
    if (header(0) != bytes.size() - word) fail(source, "an array's length does not agree with its header");
    return bytes.substr(word);
  }
  if (bytes.empty()) return {};
  const std::size_t blocks = header(0);
  if (blocks > bytes.size() / word) fail(source, "an array is shorter than its header");
  std::string out, block;
  std::size_t at = (3 + blocks) * word;
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::size_t packed = header(3 + b);
    const std::size_t size = b + 1 == blocks && header(2) > 0 ? header(2) : header(1);
    if (at > bytes.size() || packed > bytes.size() - at ||
        !zlib_expand(std::string_view(bytes).substr(at, packed), size, block)) {
      fail(source, "a compressed array is broken");
    }
    out += block;
    at += packed;
  }
  return out;
}

std::vector<double> vtk_array(const Source& source, const pugi::xml_node& array, const VtkFile& file) {
  const std::string_view format = array.attribute("format").as_string("ascii");
  const std::string_view text = array.text().get();
  if (format == "ascii") return numbers_from_text(source, text);
  if (format != "binary") {
    fail(source, fmt::format("its arrays are stored as '{}'; save it with inline (ascii or binary) data", format));
  }
  return numbers_from(source, vtk_payload(source, text, file), array.attribute("type").as_string(), file.big_endian);
}

void add_vtk_piece(const Source& source, const pugi::xml_node& piece, const VtkFile& file, TriangleMesh& mesh) {
  const std::vector<double> points = vtk_array(source, piece.child("Points").child("DataArray"), file);
  if (points.size() % 3 != 0) fail(source, "its points are not triples");
  const std::size_t first = mesh.vertices.size(), count = points.size() / 3;
  for (std::size_t i = 0; i < count; ++i)
    mesh.vertices.emplace_back(points[3 * i], points[3 * i + 1], points[3 * i + 2]);
  if (piece.attribute("NumberOfStrips").as_ullong() > 0) fail(source, "triangle strips are not supported");
  for (const pugi::xml_node& array : piece.child("PointData").children("DataArray")) {
    if (std::string_view(array.attribute("Name").as_string()) != "Normals" || mesh.normals.size() != first) continue;
    const std::vector<double> n = vtk_array(source, array, file);
    if (n.size() != 3 * count) fail(source, "it has not one normal a point");
    for (std::size_t i = 0; i < count; ++i) mesh.normals.emplace_back(n[3 * i], n[3 * i + 1], n[3 * i + 2]);
  }
  const pugi::xml_node polys = piece.child("Polys");
  const std::vector<double> corner =
      vtk_array(source, polys.find_child_by_attribute("DataArray", "Name", "connectivity"), file);
  const std::vector<double> until =
      vtk_array(source, polys.find_child_by_attribute("DataArray", "Name", "offsets"), file);
  std::vector<int> polygon;
  double from = 0.0;
  for (const double to : until) {
    if (!(to >= from && to <= static_cast<double>(corner.size()))) fail(source, "its polygon offsets are out of order");
    polygon.clear();
    for (auto i = static_cast<std::size_t>(from); i < static_cast<std::size_t>(to); ++i) {
      polygon.push_back(static_cast<int>(first) + checked_index(source, corner[i], count));
    }
    add_fan(mesh, polygon);
    from = to;
  }
}

// "SPACE=RAS" as 3D Slicer leaves it in the field data, in plain text or as character codes.
bool vtk_is_ras(const pugi::xml_node& poly_data) {
  for (const pugi::xml_node& array : poly_data.child("FieldData").children()) {
    if (std::string_view(array.attribute("Name").as_string()) != "SPACE") continue;
    const std::string text = array.text().get();
    return text.find("RAS") != std::string::npos || text.find("82 65 83") != std::string::npos;
  }
  return false;
}

template <class T>
std::string little_endian_bytes(const std::vector<T>& values) {
  std::string bytes(values.size() * sizeof(T), '\0');
  for (std::size_t i = 0; i < values.size(); ++i) {
    char raw[sizeof(T)];
    std::memcpy(raw, &values[i], sizeof(T));
    for (std::size_t k = 0; k < sizeof(T); ++k) {
      bytes[i * sizeof(T) + k] = raw[std::endian::native == std::endian::little ? k : sizeof(T) - 1 - k];
    }
  }
  return bytes;
}

template <class T>
void add_vtk_array(pugi::xml_node parent, const char* name, const char* type, int components,
                   const std::vector<T>& values) {
  pugi::xml_node array = parent.append_child("DataArray");
  array.append_attribute("type") = type;
  array.append_attribute("Name") = name;
  if (components > 1) array.append_attribute("NumberOfComponents") = components;
  array.append_attribute("format") = "binary";
  const std::string bytes = little_endian_bytes(values);
  const std::string size = little_endian_bytes(std::vector<std::uint64_t>{bytes.size()});
  array.text() = base64_encode(size + bytes).c_str();
}

std::vector<double> flat(const std::vector<Vec3>& vectors) {
  std::vector<double> out;
  out.reserve(3 * vectors.size());
  for (const Vec3& v : vectors) out.insert(out.end(), {v.x(), v.y(), v.z()});
  return out;
}

std::vector<double> gifti_array(const Source& source, const pugi::xml_node& array) {
  double expected = 1.0;
  const int dimensions = array.attribute("Dimensionality").as_int();
  for (int d = 0; d < dimensions && d < 6; ++d)
    expected *= array.attribute(fmt::format("Dim{}", d).c_str()).as_double();
  if (!(expected >= 0.0 && expected < 1e10)) fail(source, "an array has impossible dimensions");
  const std::string_view encoding = array.attribute("Encoding").as_string();
  const std::string_view text = array.child("Data").text().get();
  const std::string_view type = array.attribute("DataType").as_string();
  const bool big = std::string_view(array.attribute("Endian").as_string()) == "BigEndian";
  std::vector<double> numbers;
  if (encoding == "ASCII") {
    numbers = numbers_from_text(source, text);
  } else if (encoding == "Base64Binary" || encoding == "GZipBase64Binary") {
    std::string bytes;
    if (!base64_decode(text, bytes)) fail(source, "an array is not valid base64");
    if (encoding == "GZipBase64Binary") {
      const std::size_t width = type == "NIFTI_TYPE_UINT8" ? 1 : type.ends_with("64") ? 8 : 4;
      std::string expanded;
      if (!zlib_expand(bytes, static_cast<std::size_t>(expected) * width, expanded)) {
        fail(source, "a compressed array does not hold what its dimensions say");
      }
      bytes = std::move(expanded);
    }
    numbers = numbers_from(source, bytes, type, big);
  } else {
    fail(source, fmt::format("an array has the encoding '{}', which is not supported", encoding.substr(0, 40)));
  }
  if (static_cast<double>(numbers.size()) != expected) fail(source, "an array does not hold what its dimensions say");
  const bool by_column = std::string_view(array.attribute("ArrayIndexingOrder").as_string()) == "ColumnMajorOrder";
  if (by_column && dimensions == 2) {
    std::vector<double> rows(numbers.size());
    const std::size_t n = numbers.size() / 3;
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t c = 0; c < 3; ++c) rows[3 * i + c] = numbers[c * n + i];
    }
    return rows;
  }
  return numbers;
}

pugi::xml_node add_gifti_array(pugi::xml_node root, const char* intent, const char* type, std::size_t rows,
                               const std::string& bytes) {
  pugi::xml_node array = root.append_child("DataArray");
  array.append_attribute("Intent") = intent;
  array.append_attribute("DataType") = type;
  array.append_attribute("ArrayIndexingOrder") = "RowMajorOrder";
  array.append_attribute("Dimensionality") = 2;
  array.append_attribute("Dim0") = static_cast<unsigned long long>(rows);
  array.append_attribute("Dim1") = 3;
  array.append_attribute("Encoding") = "GZipBase64Binary";
  array.append_attribute("Endian") = "LittleEndian";
  array.append_attribute("ExternalFileName") = "";
  array.append_attribute("ExternalFileOffset") = "";
  array.append_child("MetaData");
  if (std::string_view(intent) == "NIFTI_INTENT_POINTSET") {
    // Scanner millimetres, RAS: the identity, as the coordinates need nothing more.
    pugi::xml_node system = array.append_child("CoordinateSystemTransformMatrix");
    system.append_child("DataSpace").append_child(pugi::node_cdata).set_value("NIFTI_XFORM_SCANNER_ANAT");
    system.append_child("TransformedSpace").append_child(pugi::node_cdata).set_value("NIFTI_XFORM_SCANNER_ANAT");
    system.append_child("MatrixData").text() = "\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
  }
  array.append_child("Data").text() = base64_encode(zlib_compress(bytes)).c_str();
  return array;
}

}  // namespace

TriangleMesh read_vtp(const Source& source) {
  const pugi::xml_document document = parse_xml(source);
  const pugi::xml_node root = document.child("VTKFile"), poly_data = root.child("PolyData");
  if (!poly_data) fail(source, "it is not VTK PolyData");
  const std::string_view compressor = root.attribute("compressor").as_string();
  if (!compressor.empty() && compressor != "vtkZLibDataCompressor") {
    fail(source, fmt::format("its arrays are packed by {}; save it uncompressed", compressor));
  }
  const VtkFile file{std::string_view(root.attribute("byte_order").as_string("LittleEndian")) == "BigEndian",
                     std::string_view(root.attribute("header_type").as_string("UInt32")) == "UInt64",
                     !compressor.empty()};
  TriangleMesh mesh;
  for (const pugi::xml_node& piece : poly_data.children("Piece")) add_vtk_piece(source, piece, file, mesh);
  if (mesh.normals.size() != mesh.vertices.size()) mesh.normals.clear();
  if (vtk_is_ras(poly_data)) flip_lps_ras(mesh);
  return mesh;
}

std::string write_vtp(const TriangleMesh& mesh) {
  pugi::xml_document document;
  pugi::xml_node root = document.append_child("VTKFile");
  root.append_attribute("type") = "PolyData";
  root.append_attribute("version") = "1.0";
  root.append_attribute("byte_order") = "LittleEndian";
  root.append_attribute("header_type") = "UInt64";
  pugi::xml_node poly_data = root.append_child("PolyData");
  pugi::xml_node space = poly_data.append_child("FieldData").append_child("Array");
  space.append_attribute("type") = "String";
  space.append_attribute("Name") = "SPACE";
  space.append_attribute("NumberOfTuples") = 1;
  space.append_attribute("format") = "ascii";
  space.text() = "76 80 83 0";  // "LPS" as VTK spells a string in ascii: character codes and a zero
  pugi::xml_node piece = poly_data.append_child("Piece");
  piece.append_attribute("NumberOfPoints") = static_cast<unsigned long long>(mesh.vertices.size());
  for (const char* none : {"NumberOfVerts", "NumberOfLines", "NumberOfStrips"}) piece.append_attribute(none) = 0;
  piece.append_attribute("NumberOfPolys") = static_cast<unsigned long long>(mesh.triangles.size());
  pugi::xml_node point_data = piece.append_child("PointData");
  if (!mesh.normals.empty()) {
    point_data.append_attribute("Normals") = "Normals";
    add_vtk_array(point_data, "Normals", "Float64", 3, flat(mesh.normals));
  }
  add_vtk_array(piece.append_child("Points"), "Points", "Float64", 3, flat(mesh.vertices));
  std::vector<std::int64_t> corner, until;
  for (const auto& t : mesh.triangles) {
    for (const int i : t) corner.push_back(i);
    until.push_back(static_cast<std::int64_t>(corner.size()));
  }
  pugi::xml_node polys = piece.append_child("Polys");
  add_vtk_array(polys, "connectivity", "Int64", 1, corner);
  add_vtk_array(polys, "offsets", "Int64", 1, until);
  return to_text(document);
}

TriangleMesh read_gii(const Source& source) {
  const pugi::xml_document document = parse_xml(source);
  const pugi::xml_node root = document.child("GIFTI");
  if (!root) fail(source, "it is not GIfTI");
  TriangleMesh mesh;
  std::vector<double> points, facets;
  for (const pugi::xml_node& array : root.children("DataArray")) {
    const std::string_view intent = array.attribute("Intent").as_string();
    if (intent == "NIFTI_INTENT_POINTSET" && points.empty()) points = gifti_array(source, array);
    if (intent == "NIFTI_INTENT_TRIANGLE" && facets.empty()) facets = gifti_array(source, array);
  }
  if (points.empty() || facets.empty()) fail(source, "it holds no surface (a pointset and triangles)");
  if (points.size() % 3 != 0 || facets.size() % 3 != 0) fail(source, "its points or triangles are not triples");
  for (std::size_t i = 0; i < points.size(); i += 3)
    mesh.vertices.emplace_back(points[i], points[i + 1], points[i + 2]);
  for (std::size_t i = 0; i < facets.size(); i += 3) {
    const auto corner = [&](std::size_t c) { return checked_index(source, facets[i + c], mesh.vertices.size()); };
    mesh.triangles.push_back({corner(0), corner(1), corner(2)});
  }
  flip_lps_ras(mesh);
  return mesh;
}

std::string write_gii(const TriangleMesh& mesh) {
  pugi::xml_document document;
  pugi::xml_node declaration = document.append_child(pugi::node_declaration);
  declaration.append_attribute("version") = "1.0";
  declaration.append_attribute("encoding") = "UTF-8";
  document.append_child(pugi::node_doctype)
      .set_value("GIFTI SYSTEM \"http://www.nitrc.org/frs/download.php/115/gifti.dtd\"");
  pugi::xml_node root = document.append_child("GIFTI");
  root.append_attribute("Version") = "1.0";
  root.append_attribute("NumberOfDataArrays") = 2;
  root.append_child("MetaData");
  root.append_child("LabelTable");
  std::vector<float> points;  // readers expect single precision
  for (const Vec3& v : mesh.vertices) {
    const Vec3 ras = pellicle::flip_lps_ras(v);
    for (int a = 0; a < 3; ++a) points.push_back(static_cast<float>(ras[a]));
  }
  std::vector<std::int32_t> facets;
  for (const auto& t : mesh.triangles) facets.insert(facets.end(), t.begin(), t.end());
  add_gifti_array(root, "NIFTI_INTENT_POINTSET", "NIFTI_TYPE_FLOAT32", mesh.vertices.size(),
                  little_endian_bytes(points));
  add_gifti_array(root, "NIFTI_INTENT_TRIANGLE", "NIFTI_TYPE_INT32", mesh.triangles.size(),
                  little_endian_bytes(facets));
  return to_text(document);
}

}  // namespace pellicle::mesh_formats
