#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "pellicle/mesh/files/internal/mesh_formats.h"
#include "pellicle/mesh/files/internal/point_formats.h"

namespace pellicle::point_formats {

using mesh_formats::lower_case;
using mesh_formats::parse_number;
using mesh_formats::TextCursor;

namespace {

/// Which column of a table holds what; -1: none.
struct Columns {
  int x = 0, y = 1, z = 2, weight = -1, u = -1, v = -1, least = 3;
};

char separator_of(std::string_view line) {
  for (const char c : {',', ';', '\t'}) {
    if (line.find(c) != std::string_view::npos) return c;
  }
  return ',';
}

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

}  // namespace

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
    if (first) separator = separator_of(line);
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

}  // namespace pellicle::point_formats
