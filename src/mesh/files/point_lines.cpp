#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <cstring>

#include "pellicle/mesh/files/internal/mesh_formats.h"
#include "pellicle/mesh/files/internal/point_formats.h"

namespace pellicle::point_formats {

using mesh_formats::parse_number;
using mesh_formats::TextCursor;

namespace {

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

}  // namespace

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

}  // namespace pellicle::point_formats
