#include "pellicle/mesh/files/mesh_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>

#include "pellicle/base/atomic_file.h"
#include "pellicle/base/errors.h"
#include "pellicle/mesh/files/internal/mesh_formats.h"
#include "pellicle/mesh/measure.h"

namespace pellicle {

namespace mesh_formats {

void fail(const Source& source, const std::string& why) {
  throw BadData(fmt::format("cannot read mesh ({}): {}", source.name, why));
}

int checked_index(const Source& source, double value, std::size_t count) {
  if (!(value >= 0.0 && value < static_cast<double>(count)) || value != std::floor(value)) {
    fail(source, fmt::format("a facet names vertex {}, there are {}", value, count));
  }
  return static_cast<int>(value);
}

void add_fan(TriangleMesh& mesh, const std::vector<int>& polygon) {
  for (std::size_t i = 2; i < polygon.size(); ++i) mesh.triangles.push_back({polygon[0], polygon[i - 1], polygon[i]});
}

void flip_lps_ras(TriangleMesh& mesh) {
  for (Vec3& v : mesh.vertices) v = pellicle::flip_lps_ras(v);
  for (Vec3& n : mesh.normals) n = pellicle::flip_lps_ras(n);
}

bool TextCursor::next_line(std::string_view& line) {
  if (rest_.empty()) return false;
  const auto end = rest_.find('\n');
  line = rest_.substr(0, end);
  rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return true;
}

std::string_view TextCursor::next_word() {
  constexpr std::string_view kBlank = " \t\r\n\v\f";
  const auto begin = rest_.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) {
    rest_ = {};
    return {};
  }
  rest_.remove_prefix(begin);
  const std::string_view word = rest_.substr(0, rest_.find_first_of(kBlank));
  rest_.remove_prefix(word.size());
  return word;
}

std::string lower_case(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

bool parse_number(std::string_view word, double& value) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return !word.empty() && error == std::errc{} && end == word.data() + word.size();
}

}  // namespace mesh_formats

namespace {

using mesh_formats::lower_case;
using mesh_formats::Source;

std::string whole_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::error_code failure;
  const auto size = std::filesystem::file_size(path, failure);
  if (!in || failure) {
    throw NoInput(fmt::format("cannot open mesh ({}): no such file, or it is not readable", path.string()));
  }
  std::string bytes(size, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(size));
  if (static_cast<std::uintmax_t>(in.gcount()) != size) {
    throw IoError(fmt::format("reading failed ({})", path.string()));
  }
  return bytes;
}

TriangleMesh parse(const Source& source, const std::string& extension) {
  if (extension == ".ply") return mesh_formats::read_ply(source);
  if (extension == ".stl") return mesh_formats::read_stl(source);
  if (extension == ".obj") return mesh_formats::read_obj(source);
  if (extension == ".off") return mesh_formats::read_off(source);
  if (extension == ".vtp") return mesh_formats::read_vtp(source);
  if (extension == ".gii") return mesh_formats::read_gii(source);
  mesh_formats::fail(source, fmt::format("'{}' is not a mesh format that is known here; use .ply, .stl, .obj, .off, "
                                         ".vtp or .gii",
                                         extension));
}

}  // namespace

MeshFormat mesh_format_from_name(const std::string& name) {
  const std::string n = lower_case(name);
  if (n == "ply") return MeshFormat::ply;
  if (n == "stl") return MeshFormat::stl;
  if (n == "obj") return MeshFormat::obj;
  if (n == "vtp") return MeshFormat::vtp;
  if (n == "gii") return MeshFormat::gii;
  throw UsageError(fmt::format("unknown mesh format ({}): choose one of ply, stl, obj, vtp, gii", name));
}

MeshFormat mesh_format_of_path(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  return mesh_format_from_name(extension.empty() ? path.filename().string() : extension.substr(1));
}

std::string extension_of(MeshFormat format) {
  switch (format) {
    case MeshFormat::ply:
      return ".ply";
    case MeshFormat::stl:
      return ".stl";
    case MeshFormat::obj:
      return ".obj";
    case MeshFormat::vtp:
      return ".vtp";
    case MeshFormat::gii:
      return ".surf.gii";
  }
  return ".ply";
}

void write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh, MeshFormat format) {
  check_indices(mesh);
  const auto text = [&] {
    switch (format) {
      case MeshFormat::stl:
        return mesh_formats::write_stl(mesh);
      case MeshFormat::obj:
        return mesh_formats::write_obj(mesh);
      case MeshFormat::vtp:
        return mesh_formats::write_vtp(mesh);
      case MeshFormat::gii:
        return mesh_formats::write_gii(mesh);
      case MeshFormat::ply:
        break;
    }
    return mesh_formats::write_ply(mesh);
  };
  write_text_file(path, text());
}

TriangleMesh read_mesh(const std::filesystem::path& path) {
  if (std::filesystem::is_directory(path)) {
    throw BadData(fmt::format("cannot read mesh ({}): it is a folder", path.string()));
  }
  const std::string bytes = whole_file(path);
  const Source source{bytes, path.string()};
  if (bytes.empty()) mesh_formats::fail(source, "the file is empty");
  TriangleMesh mesh = parse(source, lower_case(path.extension().string()));
  if (mesh.triangles.empty()) mesh_formats::fail(source, "it holds no facets; a surface is needed here, not points");
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    if (!mesh.vertices[i].allFinite()) mesh_formats::fail(source, fmt::format("vertex {} is not finite", i));
  }
  return mesh;
}

}  // namespace pellicle
