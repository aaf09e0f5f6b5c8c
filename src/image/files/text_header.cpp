#include "pellicle/image/files/internal/text_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <map>

#include "pellicle/image/files/internal/bad_volume.h"

namespace pellicle {
namespace fs = std::filesystem;

namespace {

using Fields = std::map<std::string, std::string>;

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string trimmed(const std::string& text) {
  const char* blank = " \t\r\n";
  const auto first = text.find_first_not_of(blank);
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(blank) - first + 1);
}

// "name: value" or "name = value" lines; ends at a blank line (NRRD) or after `last_key` (MetaImage).
Fields read_fields(std::istream& in, char separator, const std::string& last_key) {
  constexpr int most_lines = 10000;
  Fields fields;
  std::string line;
  for (int n = 0; n < most_lines && std::getline(in, line); ++n) {
    line = trimmed(line);
    if (line.empty() && last_key.empty()) break;
    const auto at = line.find(separator);
    if (line.starts_with('#') || at == std::string::npos || (separator == ':' && line.compare(at, 2, ":=") == 0))
      continue;
    const std::string key = lower(trimmed(line.substr(0, at)));
    fields[key] = trimmed(line.substr(at + 1));
    if (key == last_key) break;
  }
  return fields;
}

void take_data_file(const fs::path& path, const std::string& name, bool attached, std::uint64_t header_bytes,
                    TextHeader& header) {
  std::error_code failure;
  if (attached) {
    header.data_file = path;
    header.data_offset = header_bytes;
    header.data_file_bytes = fs::file_size(path, failure) - header_bytes;
    return;
  }
  if (name.find('%') != std::string::npos || lower(name).starts_with("list")) return;
  const fs::path data = path.parent_path() / name;
  const auto bytes = fs::file_size(data, failure);
  if (failure) {
    throw_bad_volume(path, fmt::format("a header without its data; {} is missing", data.filename().string()),
                     "put both files side by side");
  }
  header.data_file = data;
  header.data_file_bytes = bytes;
}

// How far the header was read; all of it when it ran to the end.
std::uint64_t position(std::istream& in) {
  in.clear();
  const auto at = in.tellg();
  return at < 0 ? 0 : static_cast<std::uint64_t>(at);
}

void take_unit(const std::string& name, TextHeader& header) {
  const auto mm = mm_per_named_unit(name);
  if (name.empty() || name == "?") return;
  if (mm) {
    header.unit = name;
    header.mm_per_unit = *mm;
  } else {
    header.warnings.push_back(fmt::format("The unit of length '{}' is not known; mm is assumed.", name));
  }
}

void warn_if_no_spacing(TextHeader& header) {
  if (header.has_spacing) return;
  header.warnings.emplace_back("NO SPACING in the file: 1 mm is assumed; set it with `spacing`.");
}

void read_nrrd(const fs::path& path, std::istream& in, TextHeader& header) {
  const Fields fields = read_fields(in, ':', "");
  const auto get = [&](const char* key) {
    const auto found = fields.find(key);
    return found == fields.end() ? std::string() : found->second;
  };
  const std::string encoding = lower(get("encoding"));
  using E = TextHeader::Encoding;
  if (encoding == "gzip" || encoding == "gz")
    header.encoding = E::gzip;
  else if (encoding == "bzip2" || encoding == "bz2")
    header.encoding = E::bzip2;
  else if (encoding != "raw")
    header.encoding = E::ascii;
  if (header.encoding == E::bzip2) {
    throw_bad_volume(path, "bzip2 encoding is not supported", "write it with gzip or raw encoding");
  }
  const std::string data_file = fields.contains("data file") ? get("data file") : get("datafile");
  take_data_file(path, data_file, data_file.empty(), position(in), header);
  header.skips_lines = fields.contains("line skip") || fields.contains("lineskip");
  header.has_spacing = fields.contains("space directions") || fields.contains("spacings");
  warn_if_no_spacing(header);
  if (get("space").empty()) {
    header.warnings.emplace_back(
        "The NRRD names no space: its axes are taken as left, posterior, superior, so that left and right are not "
        "certain.");
  }
  const std::string units = get("space units");
  const auto open = units.find('"'), close = units.find('"', open + 1);
  if (open != std::string::npos && close != std::string::npos)
    take_unit(units.substr(open + 1, close - open - 1), header);
}

void read_meta(const fs::path& path, std::istream& in, TextHeader& header) {
  const Fields fields = read_fields(in, '=', "elementdatafile");
  const auto get = [&](const char* key) {
    const auto found = fields.find(key);
    return found == fields.end() ? std::string() : found->second;
  };
  if (!fields.contains("ndims") || !fields.contains("elementdatafile")) {
    throw_bad_volume(path, "not a MetaImage (no NDims or no ElementDataFile)",
                     "check that the file is what its name says");
  }
  if (lower(get("compresseddata")) == "true")
    header.encoding = TextHeader::Encoding::gzip;
  else if (lower(get("binarydata")) == "false")
    header.encoding = TextHeader::Encoding::ascii;
  const std::string data_file = get("elementdatafile");
  take_data_file(path, data_file, lower(data_file) == "local", position(in), header);
  header.has_spacing = fields.contains("elementspacing") || fields.contains("elementsize");
  warn_if_no_spacing(header);
  take_unit(get("distanceunits"), header);
}

}  // namespace

std::optional<double> mm_per_named_unit(const std::string& unit) {
  static const std::map<std::string, double> known = {
      {"m", 1e3},           {"meter", 1e3},      {"metre", 1e3},      {"cm", 10.0},        {"centimeter", 10.0},
      {"mm", 1.0},          {"millimeter", 1.0}, {"um", 1e-3},        {"\xC2\xB5m", 1e-3}, {"\xCE\xBCm", 1e-3},
      {"\xB5m", 1e-3},      {"\\u00b5m", 1e-3},  {"micron", 1e-3},    {"microns", 1e-3},   {"micrometer", 1e-3},
      {"micrometre", 1e-3}, {"nm", 1e-6},        {"nanometer", 1e-6}, {"inch", 25.4},      {"in", 25.4},
      {"\xC3\x85", 1e-7},   {"angstrom", 1e-7},  {"pm", 1e-9}};
  const auto found = known.find(lower(unit));
  return found == known.end() ? std::nullopt : std::optional<double>(found->second);
}

TextHeader read_text_header(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  TextHeader header;
  std::string magic(4, '\0');
  in.read(magic.data(), 4);
  header.is_nrrd = magic == "NRRD";
  in.clear();
  in.seekg(0);
  if (header.is_nrrd)
    read_nrrd(path, in, header);
  else
    read_meta(path, in, header);
  return header;
}

}  // namespace pellicle
