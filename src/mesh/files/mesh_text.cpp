// Wavefront OBJ and Geomview OFF.
#include <fmt/format.h>

#include <iterator>

#include "pellicle/mesh/files/internal/mesh_formats.h"

namespace pellicle::mesh_formats {

namespace {

Vec3 read_vector(const Source& source, TextCursor& words, std::size_t line) {
  Vec3 x;
  for (int a = 0; a < 3; ++a) {
    if (!parse_number(words.next_word(), x[a])) fail(source, fmt::format("line {} lacks a coordinate", line));
  }
  return x;
}

// "7", "7/2", "7//3", "7/2/3"; negative counts back from the last. -1 where there is none.
int obj_index(const Source& source, std::string_view word, std::size_t count, std::size_t line) {
  double value = 0.0;
  if (!parse_number(word, value)) fail(source, fmt::format("line {}: '{}' is not a corner", line, word.substr(0, 40)));
  return checked_index(source, value < 0.0 ? static_cast<double>(count) + value : value - 1.0, count);
}

std::string_view field(std::string_view word, int which) {
  for (; which > 0; --which) {
    const auto slash = word.find('/');
    if (slash == std::string_view::npos) return {};
    word.remove_prefix(slash + 1);
  }
  return word.substr(0, word.find('/'));
}

std::string_view without_comment(std::string_view line) {
  return line.substr(0, line.find('#'));
}

// The next line that says something.
bool next_content(TextCursor& lines, std::string_view& content, std::size_t& number) {
  std::string_view line;
  while (lines.next_line(line)) {
    ++number;
    content = without_comment(line);
    if (content.find_first_not_of(" \t") != std::string_view::npos) return true;
  }
  return false;
}

}  // namespace

TriangleMesh read_obj(const Source& source) {
  TriangleMesh mesh;
  std::vector<Vec3> normals;
  bool normals_match = true, ras = false;  // corner and normal of equal number: they belong to the vertices
  std::vector<int> polygon;
  TextCursor lines(source.bytes);
  std::string_view line;
  for (std::size_t number = 1; lines.next_line(line); ++number) {
    if (line.substr(0, 1) == "#") {
      ras = ras || line.find("SPACE=RAS") != std::string_view::npos;
      continue;
    }
    TextCursor words(without_comment(line));
    const std::string_view key = words.next_word();
    if (key == "v") {
      mesh.vertices.push_back(read_vector(source, words, number));
    } else if (key == "vn") {
      normals.push_back(read_vector(source, words, number));
    } else if (key == "f") {
      polygon.clear();
      for (std::string_view word = words.next_word(); !word.empty(); word = words.next_word()) {
        const int v = obj_index(source, field(word, 0), mesh.vertices.size(), number);
        polygon.push_back(v);
        const std::string_view n = field(word, 2);
        normals_match = normals_match && !n.empty() && obj_index(source, n, normals.size(), number) == v;
      }
      if (polygon.size() < 3) fail(source, fmt::format("line {}: a facet with {} corners", number, polygon.size()));
      add_fan(mesh, polygon);
    }
  }
  if (normals_match && normals.size() == mesh.vertices.size()) mesh.normals = std::move(normals);
  if (ras) flip_lps_ras(mesh);
  return mesh;
}

std::string write_obj(const TriangleMesh& mesh) {
  std::string out = "# Wavefront OBJ, units mm\n# SPACE=LPS\n";
  auto to = std::back_inserter(out);
  for (const Vec3& v : mesh.vertices) fmt::format_to(to, "v {} {} {}\n", v.x(), v.y(), v.z());  // shortest exact form
  for (const Vec3& n : mesh.normals) fmt::format_to(to, "vn {} {} {}\n", n.x(), n.y(), n.z());
  for (const auto& t : mesh.triangles) {
    if (mesh.normals.empty()) {
      fmt::format_to(to, "f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
    } else {
      fmt::format_to(to, "f {0}//{0} {1}//{1} {2}//{2}\n", t[0] + 1, t[1] + 1, t[2] + 1);
    }
  }
  return out;
}

TriangleMesh read_off(const Source& source) {
  TextCursor lines(source.bytes);
  std::string_view line;
  std::size_t number = 0;
  if (!next_content(lines, line, number)) fail(source, "it holds nothing");
  TextCursor words(line);
  std::string_view word = words.next_word();
  const bool tagged = word.size() >= 3 && word.substr(word.size() - 3) == "OFF";
  if (!tagged || word.find('4') != std::string_view::npos || word.find('n') != std::string_view::npos) {
    fail(source, "it does not start with OFF, COFF or NOFF");
  }
  word = words.next_word();
  if (word == "BINARY") fail(source, "binary OFF is not supported; save it as text");
  if (word.empty()) {  // the counts stand on a line of their own, mostly
    if (!next_content(lines, line, number)) fail(source, "it has no counts");
    words = TextCursor(line);
    word = words.next_word();
  }
  double vertices = -1.0, facets = -1.0;
  if (!parse_number(word, vertices) || !parse_number(words.next_word(), facets) ||
      !(vertices >= 0.0 && facets >= 0.0)) {
    fail(source, fmt::format("line {} should hold the numbers of vertices and facets", number));
  }
  // A vertex takes at least "0 0 0\n" and a facet "3 0 1 2\n".
  if (6.0 * vertices + 2.0 * facets > static_cast<double>(lines.rest().size() + 2)) {
    fail(source, fmt::format("it claims {} vertices and {} facets, more than the file holds", vertices, facets));
  }
  TriangleMesh mesh;
  mesh.vertices.reserve(static_cast<std::size_t>(vertices));
  for (std::size_t v = 0; v < static_cast<std::size_t>(vertices); ++v) {
    if (!next_content(lines, line, number)) fail(source, "the file ends before its vertices are complete");
    words = TextCursor(line);
    mesh.vertices.push_back(read_vector(source, words, number));
  }
  std::vector<int> polygon;
  for (std::size_t f = 0; f < static_cast<std::size_t>(facets); ++f) {
    if (!next_content(lines, line, number)) fail(source, "the file ends before its facets are complete");
    words = TextCursor(line);
    double corners = 0.0;
    if (!parse_number(words.next_word(), corners) || !(corners >= 0.0 && corners <= static_cast<double>(line.size())))
      fail(source, fmt::format("line {} is not a facet", number));
    polygon.clear();
    for (std::size_t i = 0; i < static_cast<std::size_t>(corners); ++i) {
      double index = -1.0;
      if (!parse_number(words.next_word(), index))
        fail(source, fmt::format("line {}: the facet is incomplete", number));
      polygon.push_back(checked_index(source, index, mesh.vertices.size()));
    }
    add_fan(mesh, polygon);
  }
  return mesh;
}

}  // namespace pellicle::mesh_formats
