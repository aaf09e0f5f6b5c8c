#include "pellicle/mesh/files/point_file.h"

#include <fmt/format.h>

#include <fstream>

#include "pellicle/base/errors.h"
#include "pellicle/mesh/files/internal/mesh_formats.h"
#include "pellicle/mesh/files/internal/point_formats.h"

namespace pellicle {

namespace {

using mesh_formats::parse_number;
using mesh_formats::TextCursor;
using point_formats::fail;
using point_formats::Source;

std::string extension_of_path(const std::filesystem::path& path) {
  return mesh_formats::lower_case(path.extension().string());
}

std::string bytes_of(const std::filesystem::path& path) {
  if (std::filesystem::is_directory(path)) {
    throw BadData(fmt::format("cannot read points ({}): it is a folder", path.string()));
  }
  std::ifstream in(path, std::ios::binary);
  std::error_code failure;
  const auto size = std::filesystem::file_size(path, failure);
  if (!in || failure) {
    throw NoInput(fmt::format("cannot open points ({}): no such file, or it is not readable", path.string()));
  }
  std::string bytes(size, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(size));
  if (static_cast<std::uintmax_t>(in.gcount()) != size) {
    throw IoError(fmt::format("reading failed ({})", path.string()));
  }
  return bytes;
}

bool ply_has_facets(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::string line;
  for (int count = 0; count < 1000 && std::getline(in, line); ++count) {
    TextCursor words(line);
    const std::string_view key = words.next_word();
    if (key == "end_header") break;
    double facets = 0.0;
    if (key == "element" && words.next_word() == "face" && parse_number(words.next_word(), facets)) return facets > 0.0;
  }
  return false;
}

}  // namespace

bool is_point_file(const std::filesystem::path& path) {
  const std::string extension = extension_of_path(path);
  if (extension == ".ply") return !ply_has_facets(path);
  return extension == ".xyz" || extension == ".pts" || extension == ".csv" || extension == ".pcd";
}

PointCloud read_points(const std::filesystem::path& path) {
  const std::string bytes = bytes_of(path);
  const Source source{bytes, path.string()};
  const std::string extension = extension_of_path(path);
  if (bytes.find_first_not_of(" \t\r\n") == std::string::npos) fail(source, "the file is empty");
  PointCloud cloud;
  if (extension == ".csv") {
    cloud = point_formats::read_csv(source);
  } else if (extension == ".pcd") {
    cloud = point_formats::read_pcd(source);
  } else if (extension == ".ply") {
    cloud.points = mesh_formats::read_ply({bytes, path.string()}).vertices;
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      if (!cloud.points[i].allFinite()) fail(source, fmt::format("vertex {} is not finite", i));
    }
  } else if (extension == ".pts" && bytes.rfind("[Expe/", 0) == 0) {
    cloud = point_formats::read_expe(source);
  } else if (extension == ".xyz" || extension == ".pts") {
    cloud = point_formats::read_lines(source);
  } else {
    fail(source,
         fmt::format("'{}' is not a point format that is known here; use .xyz, .pts, .csv, .pcd or .ply", extension));
  }
  if (cloud.points.empty()) fail(source, "it holds no points");
  return cloud;
}

}  // namespace pellicle
