#include "pellicle/image/files/volume_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <new>
#include <stdexcept>

#include "pellicle/base/errors.h"
#include "pellicle/base/memory.h"
#include "pellicle/image/files/internal/dicom_series.h"
#include "pellicle/image/files/internal/itk_io.h"
#include "pellicle/image/files/internal/nifti_io.h"
#include "pellicle/image/files/internal/tiff_stack.h"
#include "pellicle/image/files/internal/voxel_source.h"

namespace pellicle {
namespace fs = std::filesystem;

namespace {

constexpr const char* supported =
    "give NIfTI (.nii, .nii.gz, .hdr/.img), NRRD (.nrrd, .nhdr), MetaImage (.mha, .mhd), a TIFF stack (.tif) or a "
    "folder "
    "with one DICOM series";

bool named(const std::string& lower_name, std::initializer_list<const char*> suffixes) {
  return std::any_of(suffixes.begin(), suffixes.end(), [&](const char* s) { return lower_name.ends_with(s); });
}

enum class Kind { nifti, itk, tiff, dicom, unknown };

Kind kind_by_name(const fs::path& path) {
  std::string name = path.filename().string();
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (named(name, {".nii", ".nii.gz", ".hdr", ".hdr.gz", ".img", ".img.gz"})) return Kind::nifti;
  if (named(name, {".nrrd", ".nhdr", ".mha", ".mhd"})) return Kind::itk;
  if (named(name, {".tif", ".tiff", ".btf", ".tf8"})) return Kind::tiff;
  if (named(name, {".dcm", ".dicom", ".ima"})) return Kind::dicom;
  return Kind::unknown;
}

// For DICOM files, which often have no extension; other unnamed files are refused by name.
bool is_dicom(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::array<char, 132> start{};
  return in.read(start.data(), start.size()) && std::memcmp(start.data() + 128, "DICM", 4) == 0;
}

VolumeSource open_by_kind(const fs::path& path, std::optional<int> frame) {
  switch (kind_by_name(path)) {
    case Kind::nifti:
      return open_nifti(path, frame);
    case Kind::itk:
      return open_itk_file(path);
    case Kind::tiff:
      return open_tiff_stack(path);
    case Kind::dicom:
      return open_dicom_file(path);
    case Kind::unknown:
      break;
  }
  if (is_dicom(path)) return open_dicom_file(path);
  throw_bad_volume(path, "not a volume format that can be read", supported);
}

VolumeSource open_volume(const fs::path& path, const ReadOptions& options) {
  std::error_code failure;
  if (!fs::exists(path, failure)) throw NoInput(fmt::format("no such file or folder ({})", path.string()));
  const bool folder = fs::is_directory(path);
  if (!folder && fs::file_size(path, failure) == 0) {
    throw_bad_volume(path, "the file is empty (zero bytes)", "copy or export it again");
  }
  VolumeSource source = folder ? open_dicom_series(path) : open_by_kind(path, options.frame);
  if (options.spacing) {
    if (!options.spacing->allFinite() || !(options.spacing->minCoeff() > 0.0)) {
      throw SettingError("bad value", "spacing", "must be three positive lengths in mm");
    }
    source.header.grid.spacing = *options.spacing;
    if (!source.header.spacing_known) {
      std::erase_if(source.header.warnings, [](const std::string& w) { return w.starts_with("NO SPACING"); });
    }
    source.header.spacing_known = true;
    source.header.nifti = nullptr;  // the file's own frame says something else now
  }
  return source;
}

template <class T>
std::vector<T> reserved(const fs::path& path, std::size_t count) {
  try {
    std::vector<T> voxels;
    voxels.reserve(count);
    prefer_large_pages(voxels.data(), count * sizeof(T));
    return voxels;
  } catch (const std::exception&) {  // bad_alloc or length_error
    throw_bad_volume(
        path,
        fmt::format("{:.1f} GB of memory are needed for its voxels", static_cast<double>(count * sizeof(T)) / 1e9),
        "use a machine with more memory or a smaller volume");
  }
}

template <class T>
T load(const VoxelBlock& block, std::size_t i) {
  T stored;
  std::memcpy(&stored, block.data + i * sizeof(T), sizeof(T));
  return stored;
}

// The slow way through a block that holds NaN or infinities, which count neither for min nor for max.
void measure_with_gaps(const float* values, std::size_t count, Volume& volume) {
  for (std::size_t i = 0; i < count; ++i) {
    const float value = values[i];
    if (std::isfinite(value)) {
      volume.min = std::min(volume.min, value);
      volume.max = std::max(volume.max, value);
    } else if (std::isnan(value)) {
      ++volume.nan_count;
    } else {
      ++volume.inf_count;
    }
  }
}

// Minimum, maximum and what is not finite. Independent lanes let the compiler use vector instructions: reading an
// uncompressed volume would otherwise be bound by these comparisons.
void measure(const float* values, std::size_t count, Volume& volume) {
  constexpr std::size_t lanes = 16;
  std::array<float, lanes> low{}, high{};
  low.fill(volume.min);
  high.fill(volume.max);
  std::array<float, lanes> poison{};  // 0 * finite = 0; NaN and infinity leave NaN
  const std::size_t whole = count - count % lanes;
  for (std::size_t i = 0; i < whole; i += lanes) {
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const float value = values[i + lane];
      low[lane] = value < low[lane] ? value : low[lane];
      high[lane] = value > high[lane] ? value : high[lane];
      poison[lane] += 0.0F * value;
    }
  }
  for (const float p : poison) {
    if (p != 0.0F) {  // NaN
      measure_with_gaps(values, count, volume);
      return;
    }
  }
  volume.min = *std::min_element(low.begin(), low.end());
  volume.max = *std::max_element(high.begin(), high.end());
  measure_with_gaps(values + whole, count - whole, volume);
}

// Appends a block to the volume, scaled. The block and what is made of it stay in the cache.
template <class T>
void append_grey(const VoxelBlock& block, double slope, double intercept, Volume& volume) {
  auto& voxels = volume.image.voxels;
  const std::size_t begin = voxels.size();
  voxels.resize(begin + block.count);
  float* out = voxels.data() + begin;
  if (slope == 1.0 && intercept == 0.0) {
    for (std::size_t i = 0; i < block.count; ++i) out[i] = static_cast<float>(load<T>(block, i));
  } else {
    for (std::size_t i = 0; i < block.count; ++i) {
      out[i] = static_cast<float>(slope * static_cast<double>(load<T>(block, i)) + intercept);
    }
  }
  measure(out, block.count, volume);
}

template <class T>
void append_labels(const VoxelBlock& block, double slope, double intercept, const fs::path& path,
                   std::vector<std::int32_t>& labels) {
  // Resampling and scaling leave float noise such as 1.99999994; anything beyond is not a label.
  constexpr double whole_within = 1e-3;
  const bool scaled = slope != 1.0 || intercept != 0.0;
  for (std::size_t i = 0; i < block.count; ++i) {
    const auto stored = static_cast<double>(load<T>(block, i));
    const double value = scaled ? slope * stored + intercept : stored;
    const double whole = std::round(value);
    if (!(std::abs(value - whole) <= whole_within)) {
      throw_bad_volume(path, fmt::format("not a label map: it holds the value {}", value),
                       "labels must be whole numbers; threshold it first");
    }
    if (!(std::abs(whole) <= static_cast<double>(std::numeric_limits<std::int32_t>::max()))) {
      throw_bad_volume(path, fmt::format("the label {} does not fit into 32 bits", value), "renumber the labels");
    }
    labels.push_back(static_cast<std::int32_t>(whole));
  }
}

void replace_non_finite(const fs::path& path, Volume& volume) {
  const std::size_t bad = volume.nan_count + volume.inf_count;
  if (bad == 0) return;
  if (bad == volume.image.voxels.size()) {
    throw_bad_volume(path, "no voxel has a finite value (all NaN or infinite)", "check how the file was made");
  }
  for (float& value : volume.image.voxels) {
    if (!std::isfinite(value)) value = volume.min;
  }
  volume.header.warnings.push_back(
      fmt::format("{} voxels are NaN and {} infinite; they count as the smallest finite value, {:g}.", volume.nan_count,
                  volume.inf_count, volume.min));
}

}  // namespace

Volume read_volume(const fs::path& path, const ReadOptions& options) {
  VolumeSource source = open_volume(path, options);
  Volume volume;
  volume.header = std::move(source.header);
  volume.image.grid = volume.header.grid;
  volume.min = std::numeric_limits<float>::infinity();
  volume.max = -std::numeric_limits<float>::infinity();
  volume.image.voxels = reserved<float>(path, volume.image.grid.voxel_count());
  const double slope = volume.header.slope, intercept = volume.header.intercept;
  source.read_blocks([&](const VoxelBlock& block) {
    with_component(block.type, [&](auto zero) { append_grey<decltype(zero)>(block, slope, intercept, volume); });
  });
  replace_non_finite(path, volume);
  return volume;
}

VolumeHeader read_header(const fs::path& path, const ReadOptions& options) {
  return open_volume(path, options).header;
}

int frame_count(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored) || kind_by_name(path) != Kind::nifti) return 1;
  return read_header(path, {.frame = 0}).frames;
}

LabelVolume read_labels(const fs::path& path, const ReadOptions& options) {
  VolumeSource source = open_volume(path, options);
  LabelVolume volume;
  volume.header = std::move(source.header);
  volume.labels.grid = volume.header.grid;
  volume.labels.voxels = reserved<std::int32_t>(path, volume.labels.grid.voxel_count());
  const double slope = volume.header.slope, intercept = volume.header.intercept;
  source.read_blocks([&](const VoxelBlock& block) {
    with_component(block.type, [&](auto zero) {
      append_labels<decltype(zero)>(block, slope, intercept, path, volume.labels.voxels);
    });
  });
  return volume;
}

}  // namespace pellicle
