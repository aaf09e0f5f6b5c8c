#include "pellicle/image/files/internal/dicom_series.h"

#include <fmt/format.h>
#include <gdcmImageReader.h>
#include <gdcmMediaStorage.h>
#include <gdcmReader.h>
#include <gdcmStringFilter.h>
#include <gdcmTrace.h>
#include <gdcmUIDs.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <vector>

#include "pellicle/image/files/internal/affine_grid.h"

namespace pellicle {
namespace fs = std::filesystem;

namespace {

struct Slice {
  fs::path path;
  std::string series, object, modality;
  int rows = 0, columns = 0, frames = 1, samples = 1;
  std::vector<double> orientation, position, pixel_spacing;
  double along_normal = 0.0;
};

void silence_gdcm() {
  gdcm::Trace::DebugOff();
  gdcm::Trace::WarningOff();
  gdcm::Trace::ErrorOff();
}

// The numbers of "1.0\2.5\..."; empty when any part is not a number.
std::vector<double> numbers(const std::string& text) {
  std::vector<double> values;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, '\\');) {
    char* end = nullptr;
    values.push_back(std::strtod(part.c_str(), &end));
    if (end == part.c_str() || !std::isfinite(values.back())) return {};
  }
  return values;
}

std::string trimmed(std::string text) {
  while (!text.empty() && (text.back() == ' ' || text.back() == '\0')) text.pop_back();
  return text;
}

// The least number of bytes that a file with these elements has: their values and eight bytes each of tag and length.
std::uint64_t least_bytes(const gdcm::DataSet& data) {
  std::uint64_t bytes = 0;
  for (auto element = data.Begin(); element != data.End(); ++element) {
    const gdcm::VL length = element->GetVL();
    if (!length.IsUndefined()) bytes += 8 + static_cast<std::uint64_t>(length);
  }
  return bytes;
}

// GDCM fills up pixels that the file does not hold any more.
bool is_truncated(const gdcm::File& file, const fs::path& path) {
  if (file.GetHeader().GetDataSetTransferSyntax() == gdcm::TransferSyntax::DeflatedExplicitVRLittleEndian) return false;
  std::error_code failure;
  const std::uint64_t on_disk = fs::file_size(path, failure);
  const std::uint64_t preamble = file.GetHeader().GetPreamble().IsEmpty() ? 0 : 132;
  return !failure && on_disk < preamble + least_bytes(file.GetHeader()) + least_bytes(file.GetDataSet());
}

// Reads the header (GDCM cannot stop before the pixels). Nothing when the file is not DICOM.
std::optional<Slice> read_slice(const fs::path& path) {
  gdcm::Reader reader;
  reader.SetFileName(path.c_str());
  if (!reader.ReadUpToTag(gdcm::Tag(0x7fe0, 0x0010))) return std::nullopt;
  if (is_truncated(reader.GetFile(), path))
    throw_bad_volume(path, "truncated DICOM file", "copy or export the series again");
  gdcm::StringFilter filter;
  filter.SetFile(reader.GetFile());
  const gdcm::DataSet& data = reader.GetFile().GetDataSet();
  const auto text = [&](std::uint16_t group, std::uint16_t element) {
    const gdcm::Tag tag(group, element);
    return data.FindDataElement(tag) ? trimmed(filter.ToString(tag)) : std::string();
  };
  const auto whole = [&](std::uint16_t group, std::uint16_t element, int otherwise) {
    const auto values = numbers(text(group, element));
    return values.empty() || std::abs(values[0]) > 1e6 ? otherwise : static_cast<int>(values[0]);
  };
  gdcm::MediaStorage storage;
  storage.SetFromFile(reader.GetFile());
  Slice slice;
  slice.path = path;
  slice.object = storage.GetString() != nullptr && storage != gdcm::MediaStorage::MS_END
                     ? gdcm::MediaStorage::GetMSString(storage)
                     : "";
  slice.series = text(0x0020, 0x000e);
  slice.modality = text(0x0008, 0x0060);
  slice.rows = whole(0x0028, 0x0010, 0);
  slice.columns = whole(0x0028, 0x0011, 0);
  slice.frames = whole(0x0028, 0x0008, 1);
  slice.samples = whole(0x0028, 0x0002, 1);
  slice.orientation = numbers(text(0x0020, 0x0037));
  slice.position = numbers(text(0x0020, 0x0032));
  slice.pixel_spacing = numbers(text(0x0028, 0x0030));
  return slice;
}

std::vector<Slice> read_folder(const fs::path& folder, std::size_t& others) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_regular_file() && !name.starts_with('.') && name != "DICOMDIR") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::vector<Slice> slices;
  for (const auto& file : files) {
    auto slice = read_slice(file);
    if (slice)
      slices.push_back(std::move(*slice));
    else
      ++others;
  }
  if (slices.empty()) {
    throw_bad_volume(folder, fmt::format("the folder holds no DICOM file ({} files of other kinds)", others),
                     "give a volume file or a folder with one DICOM series");
  }
  return slices;
}

void check_one_series(const std::vector<Slice>& slices, const fs::path& folder) {
  std::map<std::string, std::pair<std::size_t, std::string>> series;
  for (const auto& slice : slices) {
    auto& [count, modality] = series[slice.series];
    ++count;
    modality = slice.modality;
  }
  if (series.size() == 1) return;
  std::string list;
  for (const auto& [uid, entry] : series) {
    if (list.size() < 120)
      list += fmt::format("{}{} {}", list.empty() ? "" : ", ", entry.first, entry.second.empty() ? "?" : entry.second);
  }
  throw_bad_volume(folder,
                   fmt::format("mixed series: the folder holds {} DICOM series ({} files)", series.size(), list),
                   "put one series into a folder of its own");
}

// Refuses an object that is not a plain image slice.
void check_is_slice(const Slice& slice, const fs::path& named) {
  const std::string file = slice.path.filename().string();
  if (slice.modality == "SEG" || slice.modality == "RTSTRUCT" || slice.modality == "SR" || slice.modality == "RTDOSE" ||
      slice.modality == "RTPLAN") {
    throw_bad_volume(named, fmt::format("{} is a DICOM {} object, not an image", file, slice.modality),
                     "give the image series, or convert the object to NIfTI");
  }
  if (slice.frames > 1) {
    throw_bad_volume(named, fmt::format("{} is a multi-frame DICOM object of {} frames", file, slice.frames),
                     "convert it to NIfTI first");
  }
  if (slice.rows < 1 || slice.columns < 1) {
    throw_bad_volume(named,
                     fmt::format("{} is a DICOM object without pixels{}", file,
                                 slice.modality.empty() ? "" : " (" + slice.modality + ")"),
                     "give an image series");
  }
  if (slice.samples > 1)
    throw_bad_volume(named, fmt::format("the pixels of {} are RGB colours", file),
                     "convert them to one grey value each");
  if (slice.orientation.size() != 6 || slice.position.size() != 3) {
    throw_bad_volume(named, fmt::format("{} does not say where it lies (no Image Position or Orientation)", file),
                     "convert the series to NIfTI with the right geometry");
  }
}

void check_alike(const std::vector<Slice>& slices, const fs::path& folder) {
  const Slice& first = slices.front();
  for (const auto& slice : slices) {
    check_is_slice(slice, folder);
    const std::string pair = fmt::format("{} and {}", first.path.filename().string(), slice.path.filename().string());
    if (slice.rows != first.rows || slice.columns != first.columns || slice.pixel_spacing != first.pixel_spacing) {
      throw_bad_volume(folder, fmt::format("mixed sizes: {} differ in rows, columns or pixel spacing", pair),
                       "put one scan into a folder of its own");
    }
    for (std::size_t i = 0; i < 6; ++i) {
      if (!(std::abs(slice.orientation[i] - first.orientation[i]) <= 1e-3)) {
        throw_bad_volume(folder, fmt::format("mixed orientations: {} lie differently", pair),
                         "put one scan into a folder of its own");
      }
    }
  }
}

Vec3 vec3(const std::vector<double>& values, std::size_t from = 0) {
  return {values[from], values[from + 1], values[from + 2]};
}

void sort_along_normal(std::vector<Slice>& slices) {
  const auto& o = slices.front().orientation;
  const Vec3 normal = vec3(o).cross(vec3(o, 3)).normalized();
  for (auto& slice : slices) slice.along_normal = normal.dot(vec3(slice.position));
  std::stable_sort(slices.begin(), slices.end(),
                   [](const Slice& a, const Slice& b) { return a.along_normal < b.along_normal; });
}

// Slices must stand at equal steps along one line, to a tenth of the step (positions are often rounded to 0.1 mm).
Vec3 slice_step(const std::vector<Slice>& slices, const fs::path& folder) {
  std::vector<double> gaps;
  for (std::size_t i = 1; i < slices.size(); ++i) gaps.push_back(slices[i].along_normal - slices[i - 1].along_normal);
  std::vector<double> sorted = gaps;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
  const double typical = sorted[sorted.size() / 2];
  for (std::size_t i = 0; i < gaps.size(); ++i) {
    const std::string pair =
        fmt::format("{} and {}", slices[i].path.filename().string(), slices[i + 1].path.filename().string());
    if (!(gaps[i] > 0.01 * typical) || !(gaps[i] > 1e-6)) {
      throw_bad_volume(folder, fmt::format("two slices at one position: {}", pair),
                       "the series holds several volumes or copies; keep one");
    }
    if (!(std::abs(gaps[i] - typical) <= 0.1 * typical)) {
      const double missing = std::round(gaps[i] / typical) - 1.0;
      const bool whole = missing >= 1.0 && std::abs(gaps[i] / typical - missing - 1.0) <= 0.1;
      throw_bad_volume(
          folder,
          whole ? fmt::format("uneven slices: {:.0f} missing between {} (gap {:.4g} mm, elsewhere {:.4g} mm)", missing,
                              pair, gaps[i], typical)
                : fmt::format("uneven slices: the gap between {} is {:.4g} mm, elsewhere {:.4g} mm", pair, gaps[i],
                              typical),
          "complete the series or resample it to even slices");
    }
  }
  const Vec3 first = vec3(slices.front().position);
  Vec3 step = (vec3(slices.back().position) - first) / static_cast<double>(slices.size() - 1);
  for (std::size_t i = 0; i < slices.size(); ++i) {
    if (!((vec3(slices[i].position) - first - static_cast<double>(i) * step).norm() <= 0.1 * typical)) {
      throw_bad_volume(
          folder,
          fmt::format("uneven slices: {} is off the line through the others", slices[i].path.filename().string()),
          "complete the series or resample it to even slices");
    }
  }
  return step;
}

ImageGrid grid_of(const std::vector<Slice>& slices, const fs::path& folder, VolumeHeader& header) {
  const Slice& first = slices.front();
  Vec3 spacing(1, 1, 0);
  if (first.pixel_spacing.size() == 2 && first.pixel_spacing[0] > 0.0 && first.pixel_spacing[1] > 0.0) {
    spacing << first.pixel_spacing[1], first.pixel_spacing[0], 0.0;  // stored as row spacing, column spacing
  } else {
    header.spacing_known = false;
    header.warnings.emplace_back("NO SPACING of pixels in the DICOM series: 1 mm is assumed; set it with `spacing`.");
  }
  Mat3 matrix;
  matrix.col(0) = vec3(first.orientation) * spacing[0];
  matrix.col(1) = vec3(first.orientation, 3) * spacing[1];
  matrix.col(2) = slice_step(slices, folder);
  return grid_from_affine(folder, {first.columns, first.rows, static_cast<int>(slices.size())}, matrix,
                          vec3(first.position), header.warnings);
}

ComponentType component_of(const gdcm::PixelFormat& format, const fs::path& path) {
  switch (format.GetScalarType()) {
    case gdcm::PixelFormat::UINT8:
      return ComponentType::uint8;
    case gdcm::PixelFormat::INT8:
      return ComponentType::int8;
    case gdcm::PixelFormat::UINT12:
    case gdcm::PixelFormat::UINT16:
      return ComponentType::uint16;
    case gdcm::PixelFormat::INT12:
    case gdcm::PixelFormat::INT16:
      return ComponentType::int16;
    case gdcm::PixelFormat::UINT32:
      return ComponentType::uint32;
    case gdcm::PixelFormat::INT32:
      return ComponentType::int32;
    case gdcm::PixelFormat::FLOAT32:
      return ComponentType::float32;
    case gdcm::PixelFormat::FLOAT64:
      return ComponentType::float64;
    default:
      throw_bad_volume(path, fmt::format("DICOM pixels of type {} are not supported", format.GetScalarTypeAsString()),
                       "convert the series to NIfTI");
  }
}

// One slice, rescaled. Slopes may differ from slice to slice (PET), so that they are applied here.
void read_pixels(const Slice& slice, const std::function<void(const VoxelBlock&)>& consume) {
  gdcm::ImageReader reader;
  reader.SetFileName(slice.path.c_str());
  if (!reader.Read())
    throw_bad_volume(slice.path, "its DICOM pixels cannot be decoded", "copy or export the series again");
  const gdcm::Image& image = reader.GetImage();
  const ComponentType type = component_of(image.GetPixelFormat(), slice.path);
  const std::size_t count = static_cast<std::size_t>(slice.rows) * static_cast<std::size_t>(slice.columns);
  std::vector<char> bytes(image.GetBufferLength());
  if (bytes.size() != count * size_in_bytes(type) || !image.GetBuffer(bytes.data())) {
    throw_bad_volume(slice.path, "truncated or damaged DICOM pixels", "copy or export the series again");
  }
  const double slope = image.GetSlope(), intercept = image.GetIntercept();
  if (slope == 0.0 || (slope == 1.0 && intercept == 0.0)) {
    consume({type, reinterpret_cast<const std::byte*>(bytes.data()), count});
    return;
  }
  std::vector<double> scaled(count);
  with_component(type, [&](auto zero) {
    for (std::size_t i = 0; i < count; ++i) {
      auto stored = zero;
      std::memcpy(&stored, bytes.data() + i * sizeof stored, sizeof stored);
      scaled[i] = slope * static_cast<double>(stored) + intercept;
    }
  });
  consume({ComponentType::float64, reinterpret_cast<const std::byte*>(scaled.data()), count});
}

void describe_pixels(const Slice& slice, VolumeHeader& header) {
  gdcm::ImageReader reader;
  reader.SetFileName(slice.path.c_str());
  if (!reader.Read())
    throw_bad_volume(slice.path, "its DICOM pixels cannot be decoded", "copy or export the series again");
  header.component_type = name_of(component_of(reader.GetImage().GetPixelFormat(), slice.path));
  header.slope = 1.0;  // applied slice by slice, see read_pixels
}

}  // namespace

VolumeSource open_dicom_series(const fs::path& folder) {
  silence_gdcm();
  std::size_t others = 0;
  std::vector<Slice> slices = read_folder(folder, others);
  check_one_series(slices, folder);
  check_alike(slices, folder);
  if (slices.size() == 1)
    throw_bad_volume(folder, "the series has a single slice, which is a 2D image", "give the whole series");
  sort_along_normal(slices);
  VolumeSource source;
  VolumeHeader& header = source.header;
  header.format = "DICOM series";
  header.unit = "mm";
  if (others > 0)
    header.warnings.push_back(fmt::format("{} files in the folder are not DICOM and were ignored.", others));
  header.grid = grid_of(slices, folder, header);
  check_size(folder, {header.grid.size[0], header.grid.size[1], header.grid.size[2]});
  describe_pixels(slices.front(), header);
  source.read_blocks = [slices](const auto& consume) {
    for (const auto& slice : slices) read_pixels(slice, consume);
  };
  return source;
}

VolumeSource open_dicom_file(const fs::path& path) {
  silence_gdcm();
  const auto slice = read_slice(path);
  if (!slice) throw_bad_volume(path, "damaged or not a DICOM file", "check that the file is what its name says");
  check_is_slice(*slice, path);
  throw_bad_volume(path, "one DICOM slice, which is a 2D image", "give the folder that holds its series");
}

}  // namespace pellicle
