#include "pellicle/image/files/internal/itk_io.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "pellicle/image/files/internal/affine_grid.h"
#include "pellicle/image/files/internal/gz_file.h"
#include "pellicle/image/files/internal/itk_decoder.h"
#include "pellicle/image/files/internal/text_header.h"

namespace pellicle {
namespace fs = std::filesystem;

namespace {

[[noreturn]] void refuse(const fs::path& path, const std::runtime_error& error) {
  throw_bad_volume(path, fmt::format("damaged, truncated or not supported ({})", error.what()),
                   "copy or export the file again");
}

ComponentType component_of(const ItkVolume& volume, const fs::path& path) {
  constexpr std::array types = {ComponentType::uint8,  ComponentType::int8,   ComponentType::uint16,
                                ComponentType::int16,  ComponentType::uint32, ComponentType::int32,
                                ComponentType::uint64, ComponentType::int64,  ComponentType::float32,
                                ComponentType::float64};
  for (const ComponentType type : types) {
    const char first = name_of(type)[0];  // u, i or f
    if (first == volume.kind && size_in_bytes(type) == volume.bytes_per_component) return type;
  }
  throw_bad_volume(path, "its voxel type is not supported", "convert it to float32");
}

void check_scalar(const ItkVolume& volume, const fs::path& path) {
  using Pixel = ItkVolume::Pixel;
  if (volume.pixel == Pixel::rgb)
    throw_bad_volume(path, "the voxels are RGB colours", "convert them to one grey value each");
  if (volume.pixel == Pixel::complex)
    throw_bad_volume(path, "the voxels are complex numbers", "convert them to magnitudes");
  if (volume.pixel != Pixel::scalar || volume.components != 1) {
    throw_bad_volume(path, fmt::format("{} values per voxel (RGB, vectors or 4D)", volume.components),
                     "extract one grey-scale volume first");
  }
}

Index3 size_of(const ItkVolume& volume, const fs::path& path) {
  std::array<std::int64_t, 3> size{1, 1, 1};
  std::string shape;
  bool several = false;
  for (std::size_t axis = 0; axis < volume.size.size(); ++axis) {
    const std::int64_t n = volume.size[axis];
    shape += fmt::format("{}{}", axis > 0 ? "x" : "", n);
    if (axis < 3)
      size[axis] = n;
    else
      several = several || n > 1;
  }
  if (several)
    throw_bad_volume(path, fmt::format("{}D data of {} voxels: several volumes in one file", volume.size.size(), shape),
                     "extract one 3D volume first");
  check_size(path, size);
  return {static_cast<int>(size[0]), static_cast<int>(size[1]), static_cast<int>(size[2])};
}

void check_data_size(const TextHeader& text, std::uint64_t bytes, std::uint64_t voxels, const fs::path& path) {
  if (!text.data_file_bytes) return;  // spread over several files: a short one is found when it is read
  const bool ascii = text.encoding == TextHeader::Encoding::ascii;
  check_claim(path, ascii ? voxels : bytes, *text.data_file_bytes, text.encoding == TextHeader::Encoding::gzip);
}

ImageGrid grid_of(const ItkVolume& volume, const Index3& size, double mm, const fs::path& path, VolumeHeader& header) {
  Mat3 matrix;
  Vec3 origin;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    for (int row = 0; row < 3; ++row)
      matrix(row, axis) = volume.direction[a][static_cast<std::size_t>(row)] * volume.spacing[a] * mm;
    origin[axis] = volume.origin[a] * mm;
  }
  return grid_from_affine(path, size, matrix, origin, header.warnings);
}

}  // namespace

VolumeSource open_itk_file(const fs::path& path) {
  const TextHeader text = read_text_header(path);
  ItkVolume volume;
  try {
    volume = open_with_itk(path.string(), text.is_nrrd);
  } catch (const std::runtime_error& error) {
    refuse(path, error);
  }
  VolumeSource source;
  VolumeHeader& header = source.header;
  header.format = text.is_nrrd ? "NRRD" : "MetaImage";
  header.warnings = text.warnings;
  header.unit = text.unit;
  header.spacing_known = text.has_spacing;
  check_scalar(volume, path);
  const Index3 size = size_of(volume, path);
  const ComponentType type = component_of(volume, path);
  header.component_type = name_of(type);
  header.grid = grid_of(volume, size, text.mm_per_unit, path, header);
  const std::size_t count = header.grid.voxel_count();
  check_data_size(text, static_cast<std::uint64_t>(count) * size_in_bytes(type), count, path);
  const bool verify = text.encoding == TextHeader::Encoding::gzip && text.data_file_bytes && !text.skips_lines;
  source.read_blocks = [read = volume.read, type, count, path, text, verify](const auto& consume) {
    // MetaIO takes what zlib gives, whole or not; the NRRD reader sees it but leaks.
    if (verify) check_deflated(path, text.data_file, text.data_offset, count * size_in_bytes(type));
    std::vector<std::byte> bytes(count * size_in_bytes(type));
    try {
      read(bytes.data());
    } catch (const std::runtime_error& error) {
      refuse(path, error);
    }
    constexpr std::size_t block = 1U << 17;  // fits into the cache together with what is made of it
    for (std::size_t done = 0; done < count; done += block) {
      consume({type, bytes.data() + done * size_in_bytes(type), std::min(block, count - done)});
    }
  };
  return source;
}

}  // namespace pellicle
