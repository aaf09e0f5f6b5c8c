#include "pellicle/mesh/files/point_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>

#include "pellicle/base/errors.h"
#include "pellicle/mesh/files/mesh_formats.h"
#include "pellicle/mesh/files/point_formats.h"

namespace pellicle {

namespace point_formats {

void fail(const Source& source, const std::string& why) {
  throw BadData(fmt::format("cannot read points ({}): {}", source.name, why));
}

void check_finite(const Source& source, const Vec3& x, std::size_t line) {
  if (!x.allFinite()) fail(source, fmt::format("line {}: a coordinate is not finite", line));
}

}  // namespace point_formats

namespace {

using mesh_formats::parse_number;
using mesh_formats::TextCursor;
using point_formats::check_finite;
using point_formats::fail;
using point_formats::Source;

std::string lower_case(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

std::string extension_of_path(const std::filesystem::path& path) {
  return lower_case(path.extension().string());
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

// Words between blanks, commas and semicolons.
std::vector<std::string_view> words_of(std::string_view line) {
  constexpr std::string_view kBetween = " \t\r\v\f,;";
  std::vector<std::string_view> words;
  for (auto begin = line.find_first_not_of(kBetween); begin != std::string_view::npos;
       begin = line.find_first_not_of(kBetween)) {
    line.remove_prefix(begin);
    words.push_back(line.substr(0, line.find_first_of(kBetween)));
    line.remove_prefix(words.back().size());
  }
  return words;
}

bool is_letter(std::string_view word) {
  return word.size() == 1 && std::isalpha(static_cast<unsigned char>(word[0])) != 0;
}

PointCloud read_lines(const Source& source) {
  PointCloud cloud;
  TextCursor lines(source.bytes);
  std::string_view line;
  double claimed = -1.0;
  for (std::size_t number = 1; lines.next_line(line); ++number) {
    std::vector<std::string_view> words = words_of(line.substr(0, line.find('#')));
    if (words.empty()) continue;
    if (is_letter(words[0])) {
      if (words[0] != "p" && words[0] != "v") continue;  // other records of the same file
      words.erase(words.begin());
    }
    if (words.size() == 1 && cloud.points.empty() && claimed < 0.0) {
      if (!parse_number(words[0], claimed) || claimed < 0.0 || claimed != std::floor(claimed)) {
        fail(source,
             fmt::format("line {}: '{}' is neither a point nor a number of points", number, words[0].substr(0, 40)));
      }
      continue;
    }
    if (words.size() < 3) fail(source, fmt::format("line {} has {} numbers; a point has x y z", number, words.size()));
    Vec3 x;
    for (int a = 0; a < 3; ++a) {
      const std::string_view word = words[static_cast<std::size_t>(a)];
      if (!parse_number(word, x[a]))
        fail(source, fmt::format("line {}: '{}' is not a number", number, word.substr(0, 40)));
    }
    check_finite(source, x, number);
    cloud.points.push_back(x);
  }
  if (claimed >= 0.0 && claimed != static_cast<double>(cloud.points.size())) {
    fail(source, fmt::format("it claims {} points and holds {}; is it truncated?", claimed, cloud.points.size()));
  }
  return cloud;
}

/// Which column of a table holds what; -1: none.
struct Columns {
  int x = 0, y = 1, z = 2, weight = -1, u = -1, v = -1, least = 3;
};

std::vector<std::string_view> fields_of(std::string_view line, char separator) {
  std::vector<std::string_view> fields;
  while (true) {
    const auto end = line.find(separator);
    std::string_view field = line.substr(0, end);
    const auto begin = field.find_first_not_of(" \t\"");
    field = begin == std::string_view::npos ? std::string_view() : field.substr(begin);
    field = field.substr(0, field.find_last_not_of(" \t\"") + 1);
    fields.push_back(field);
    if (end == std::string_view::npos) return fields;
    line.remove_prefix(end + 1);
  }
}

Columns named_columns(const Source& source, const std::vector<std::string_view>& names) {
  Columns columns{-1, -1, -1, -1, -1, -1, static_cast<int>(names.size())};
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string name = lower_case(names[i]);
    const int at = static_cast<int>(i);
    if (name == "x") columns.x = at;
    if (name == "y") columns.y = at;
    if (name == "z") columns.z = at;
    if (name == "weight" || name == "w") columns.weight = at;
    if (name == "u_index" || name == "k") columns.u = at;
    if (name == "v_index" || name == "l") columns.v = at;
  }
  if (columns.x < 0 || columns.y < 0 || columns.z < 0) {
    fail(source, "its columns lack x, y or z; name them x,y,z[,weight] in the first line");
  }
  if ((columns.u < 0) != (columns.v < 0)) fail(source, "it has only one of the columns u_index and v_index");
  return columns;
}

struct GridCell {
  int k, l;
  Vec3 x;
};

PointGrid grid_of(const Source& source, const std::vector<GridCell>& cells) {
  PointGrid grid;
  for (const GridCell& c : cells) {
    grid.columns = std::max(grid.columns, c.k + 1);
    grid.rows = std::max(grid.rows, c.l + 1);
  }
  const auto columns = static_cast<std::size_t>(grid.columns), rows = static_cast<std::size_t>(grid.rows);
  if (rows > cells.size() || columns > cells.size()) {
    fail(source,
         fmt::format("its indices go up to {} x {}, but it holds {} points", grid.columns, grid.rows, cells.size()));
  }
  grid.points.assign(columns * rows, Vec3::Zero());
  std::vector<int> filled(columns * rows, 0), in_row(rows, 0);
  for (const GridCell& c : cells) {
    const std::size_t at = static_cast<std::size_t>(c.l) * columns + static_cast<std::size_t>(c.k);
    if (filled[at] != 0) fail(source, fmt::format("the point (u_index {}, v_index {}) is given twice", c.k, c.l));
    grid.points[at] = c.x;
    filled[at] = 1;
    ++in_row[static_cast<std::size_t>(c.l)];
  }
  for (std::size_t l = 0; l < rows; ++l) {
    const bool end = l == 0 || l + 1 == rows;
    for (std::size_t k = 0; k < columns; ++k) {
      if (filled[l * columns + k] != 0) continue;
      if (!(end && in_row[l] == 1)) fail(source, fmt::format("the point (u_index {}, v_index {}) is missing", k, l));
      const auto only = std::find(filled.begin() + static_cast<std::ptrdiff_t>(l * columns),
                                  filled.begin() + static_cast<std::ptrdiff_t>((l + 1) * columns), 1);
      grid.points[l * columns + k] = grid.points[static_cast<std::size_t>(only - filled.begin())];
    }
  }
  return grid;
}

PointCloud read_csv(const Source& source) {
  PointCloud cloud;
  std::vector<GridCell> cells;
  TextCursor lines(source.bytes);
  std::string_view line;
  Columns columns;
  char separator = ',';
  bool first = true;
  for (std::size_t number = 1; lines.next_line(line); ++number) {
    line = line.substr(0, line.find('#'));
    if (line.find_first_not_of(" \t,;") == std::string_view::npos) continue;
    if (first) {
      for (const char c : {',', ';', '\t'}) {
        if (line.find(c) != std::string_view::npos) {
          separator = c;
          break;
        }
      }
    }
    const auto fields = fields_of(line, separator);
    double ignored = 0.0;
    if (first && !parse_number(fields[0], ignored)) {
      columns = named_columns(source, fields);
      first = false;
      continue;
    }
    if (first && fields.size() == 4) columns.weight = 3;
    if (first && fields.size() > 4) {
      fail(source,
           fmt::format("it has {} columns without names; name them x,y,z[,weight] in the first line", fields.size()));
    }
    if (first) columns.least = static_cast<int>(fields.size());
    first = false;
    if (static_cast<int>(fields.size()) != columns.least || fields.size() < 3) {
      fail(source,
           fmt::format("line {} has {} columns, {} are due", number, fields.size(), std::max(3, columns.least)));
    }
    const auto value = [&](int column) {
      double v = 0.0;
      const std::string_view field = fields[static_cast<std::size_t>(column)];
      if (!parse_number(field, v))
        fail(source, fmt::format("line {}: '{}' is not a number", number, field.substr(0, 40)));
      return v;
    };
    const Vec3 x(value(columns.x), value(columns.y), value(columns.z));
    check_finite(source, x, number);
    if (columns.weight >= 0) {
      const double w = value(columns.weight);
      if (!(w >= 0.0 && std::isfinite(w)))
        fail(source, fmt::format("line {}: the weight {} is not 0 or more", number, w));
      cloud.weights.push_back(w);
    }
    if (columns.u >= 0) {
      const double k = value(columns.u), l = value(columns.v);
      const auto whole = [](double v) { return v >= 0.0 && v < 1e6 && v == std::floor(v); };
      if (!whole(k) || !whole(l))
        fail(source, fmt::format("line {}: the indices must be whole numbers from 0", number));
      cells.push_back({static_cast<int>(k), static_cast<int>(l), x});
    }
    cloud.points.push_back(x);
  }
  if (columns.u >= 0 && !cells.empty()) cloud.grid = grid_of(source, cells);
  return cloud;
}

// "[Expe/PointSet/Binary/0.1]", "property NAME BYTES" ..., "nofpoints N", "data", then packed little-endian records.
PointCloud read_expe(const Source& source) {
  TextCursor lines(source.bytes);
  std::string_view line;
  std::size_t stride = 0, position = std::string::npos, count = 0;
  while (lines.next_line(line) && line != "data") {
    TextCursor words(line);
    const std::string_view key = words.next_word(), name = words.next_word();
    double bytes = 0.0;
    if (key == "property") {
      if (!parse_number(words.next_word(), bytes) || !(bytes > 0.0 && bytes < 1024.0))
        fail(source, "a property has no size");
      if (name == "position") position = stride;
      if (name == "position" && bytes != 12.0) fail(source, "positions that are not three floats are not supported");
      stride += static_cast<std::size_t>(bytes);
    } else if (key == "nofpoints") {
      if (!parse_number(name, bytes) || !(bytes >= 0.0)) fail(source, "it does not say how many points there are");
      if (bytes > static_cast<double>(source.bytes.size())) fail(source, "it claims more points than the file holds");
      count = static_cast<std::size_t>(bytes);
    }
  }
  if (position == std::string::npos) fail(source, "its points have no position");
  const std::string_view data = lines.rest();
  if (data.size() < count * stride)
    fail(source, fmt::format("it claims {} points, more than the file holds; is it truncated?", count));
  PointCloud cloud;
  cloud.points.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    float v[3];
    std::memcpy(v, data.data() + i * stride + position, sizeof v);
    const Vec3 x(static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2]));
    if (!x.allFinite()) fail(source, fmt::format("point {} is not finite", i));
    cloud.points.push_back(x);
  }
  return cloud;
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
    cloud = read_csv(source);
  } else if (extension == ".pcd") {
    cloud = point_formats::read_pcd(source);
  } else if (extension == ".ply") {
    cloud.points = mesh_formats::read_ply({bytes, path.string()}).vertices;
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      if (!cloud.points[i].allFinite()) fail(source, fmt::format("vertex {} is not finite", i));
    }
  } else if (extension == ".pts" && bytes.rfind("[Expe/", 0) == 0) {
    cloud = read_expe(source);
  } else if (extension == ".xyz" || extension == ".pts") {
    cloud = read_lines(source);
  } else {
    fail(source,
         fmt::format("'{}' is not a point format that is known here; use .xyz, .pts, .csv, .pcd or .ply", extension));
  }
  if (cloud.points.empty()) fail(source, "it holds no points");
  return cloud;
}

}  // namespace pellicle
