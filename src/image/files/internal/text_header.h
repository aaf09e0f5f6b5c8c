#pragma once
/// What the text headers of NRRD and MetaImage say beyond what ITK's readers pass on.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace pellicle {

struct TextHeader {
  enum class Encoding { raw, gzip, ascii, bzip2 };
  bool is_nrrd = false;
  bool has_spacing = false;
  bool skips_lines = false;  ///< an NRRD whose data begin some lines after data_offset
  Encoding encoding = Encoding::raw;
  std::string unit = "unknown";
  double mm_per_unit = 1.0;
  std::filesystem::path data_file;               ///< empty when the data are spread over several files
  std::uint64_t data_offset = 0;                 ///< where the data start in it, before skips that the header orders
  std::optional<std::uint64_t> data_file_bytes;  ///< from there to its end; none for several files
  std::vector<std::string> warnings;
};

/// Tells the two formats apart by their content.
/// \throws BadData: neither, or the data file is missing.
TextHeader read_text_header(const std::filesystem::path& path);

/// mm per unit of length by its name ("um", "micron", "mm", "cm", "inch", ...); nothing for "pixel" and the unknown.
std::optional<double> mm_per_named_unit(const std::string& unit);

}  // namespace pellicle
