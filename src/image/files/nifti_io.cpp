#include "pellicle/image/files/internal/nifti_io.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "pellicle/image/files/internal/nifti_header.h"

namespace pellicle {
namespace fs = std::filesystem;

namespace {

struct NiftiFiles {
  fs::path header, voxels;
};

fs::path with_extension(const fs::path& path, const std::string& from, const std::string& to) {
  const std::string name = path.string();
  return name.substr(0, name.size() - from.size()) + to;
}

bool has_suffix(const fs::path& path, const std::string& suffix) {
  return path.string().ends_with(suffix);
}

fs::path first_existing(const std::vector<fs::path>& candidates) {
  for (const auto& candidate : candidates) {
    if (fs::exists(candidate)) return candidate;
  }
  return {};
}

// The other half of a pair, whichever half was named.
NiftiFiles find_files(const fs::path& path) {
  for (const std::string gz : {"", ".gz"}) {
    const std::string other_gz = gz.empty() ? ".gz" : "";
    for (const bool named_header : {true, false}) {
      const std::string mine = (named_header ? ".hdr" : ".img") + gz, other = named_header ? ".img" : ".hdr";
      if (!has_suffix(path, mine)) continue;
      const fs::path found =
          first_existing({with_extension(path, mine, other + gz), with_extension(path, mine, other + other_gz)});
      if (found.empty()) {
        throw_bad_volume(path,
                         fmt::format("one half of a pair; {} is missing",
                                     with_extension(path, mine, other + gz).filename().string()),
                         "put both files side by side");
      }
      return named_header ? NiftiFiles{path, found} : NiftiFiles{found, path};
    }
  }
  return {path, path};
}

ComponentType component_of(const NiftiHeader& header, const fs::path& path) {
  switch (header.fields.datatype) {
    case DT_UINT8:
      return ComponentType::uint8;
    case DT_INT8:
      return ComponentType::int8;
    case DT_UINT16:
      return ComponentType::uint16;
    case DT_INT16:
      return ComponentType::int16;
    case DT_UINT32:
      return ComponentType::uint32;
    case DT_INT32:
      return ComponentType::int32;
    case DT_UINT64:
      return ComponentType::uint64;
    case DT_INT64:
      return ComponentType::int64;
    case DT_FLOAT32:
      return ComponentType::float32;
    case DT_FLOAT64:
      return ComponentType::float64;
    case DT_RGB24:
    case DT_RGBA32:
      throw_bad_volume(path, "the voxels are RGB colours", "convert them to one grey value each");
    case DT_COMPLEX64:
    case DT_COMPLEX128:
    case DT_COMPLEX256:
      throw_bad_volume(path, "the voxels are complex numbers", "convert them to magnitudes");
    default:
      throw_bad_volume(path,
                       fmt::format("voxels of type {} (code {}) are not supported",
                                   nifti_datatype_string(header.fields.datatype), header.fields.datatype),
                       "convert them to float32");
  }
}

Index3 size_of(const NiftiHeader& header, bool as_series, const fs::path& path) {
  const auto& dim = header.fields.dim;
  if (dim[0] < 1 || dim[0] > 7) {
    throw_bad_volume(path, fmt::format("the header claims {} dimensions", dim[0]),
                     "the file is damaged; export it again");
  }
  if (header.fields.intent_code >= 3000 && header.fields.intent_code < 3100) {
    throw_bad_volume(path, "a CIFTI matrix, not a volume", "give the volume that it was made from");
  }
  std::array<std::int64_t, 3> size{1, 1, 1};
  std::string shape;
  std::int64_t volumes = 1;
  for (std::int64_t axis = 1; axis <= dim[0]; ++axis) {
    const std::int64_t n = dim[axis];
    shape += fmt::format("{}{}", axis > 1 ? "x" : "", n);
    if (axis <= 3) size[static_cast<std::size_t>(axis) - 1] = n;
    // Unused trailing dimensions are written as 0 by some programs.
    else if (n > 1)
      volumes = std::min<std::int64_t>(n, 1 << 30) * std::min<std::int64_t>(volumes, 1 << 30);
    else if (n < 0)
      throw_bad_volume(path, fmt::format("the header claims an impossible size of {} voxels", shape),
                       "the file is damaged; export it again");
  }
  if (volumes > 1 && !(as_series && dim[4] == volumes)) {
    throw_bad_volume(path,
                     fmt::format("{} data of {} voxels: {} volumes in one file",
                                 dim[0] == 4 ? "4D" : fmt::format("{}D", dim[0]), shape, volumes),
                     "extract one 3D volume first");
  }
  check_size(path, size);
  return {static_cast<int>(size[0]), static_cast<int>(size[1]), static_cast<int>(size[2])};
}

// The fourth axis. What is known not to be time is refused: its volumes are not states of one object.
void take_frames(const NiftiHeader& header, int frame, const fs::path& path, VolumeHeader& out) {
  const auto& dim = header.fields.dim;
  out.frames = dim[0] >= 4 ? static_cast<int>(std::max<std::int64_t>(1, dim[4])) : 1;
  if (frame < 0 || frame >= out.frames) {
    throw_bad_volume(path, fmt::format("there is no frame {}", frame), fmt::format("it has {} of them", out.frames));
  }
  if (out.frames == 1) return;
  const int unit = XYZT_TO_TIME(header.fields.xyzt_units);
  const double seconds = unit == NIFTI_UNITS_SEC    ? 1.0
                         : unit == NIFTI_UNITS_MSEC ? 1e-3
                         : unit == NIFTI_UNITS_USEC ? 1e-6
                                                    : 0.0;
  if (seconds == 0.0 && unit != NIFTI_UNITS_UNKNOWN) {
    throw_bad_volume(path, fmt::format("the fourth axis is not time ({})", nifti_units_string(unit)),
                     "extract one 3D volume first");
  }
  const double step = header.fields.pixdim[4];
  const bool known = seconds > 0.0 && std::isfinite(step) && step > 0.0;
  out.frame_step = known ? seconds * step : 1.0;
  out.frame_unit = known ? "s" : "frame";
}

void take_scaling(const NiftiHeader& header, VolumeHeader& out) {
  const double slope = header.fields.scl_slope, inter = header.fields.scl_inter;
  if (header.version == 0 || !std::isfinite(slope) || slope == 0.0) return;
  out.slope = slope;
  out.intercept = std::isfinite(inter) ? inter : 0.0;
}

// Where the voxels start, bytes from the begin of their (unpacked) file.
std::uint64_t voxel_offset(const NiftiHeader& header, const fs::path& path) {
  const std::int64_t stored = header.fields.vox_offset;
  const std::int64_t least = !header.single_file ? 0 : header.version == 2 ? 544 : 352;
  if (stored < 0)
    throw_bad_volume(path, "the header claims a negative or absurd data offset",
                     "the file is damaged; export it again");
  return static_cast<std::uint64_t>(std::max(stored, least));
}

void stream_voxels(GzFile& file, ComponentType type, bool swapped, std::size_t count,
                   const std::function<void(const VoxelBlock&)>& consume) {
  constexpr std::size_t block = 1U << 17;
  const std::size_t width = size_in_bytes(type);
  std::vector<std::byte> bytes(std::min(block, count) * width);
  for (std::size_t done = 0; done < count;) {
    const std::size_t step = std::min(block, count - done);
    file.read_exact(bytes.data(), step * width);
    if (swapped && width > 1) nifti_swap_Nbytes(static_cast<std::int64_t>(step), static_cast<int>(width), bytes.data());
    consume({type, bytes.data(), step});
    done += step;
  }
  file.check_rest();
}

}  // namespace

VolumeSource open_nifti(const fs::path& path, std::optional<int> frame_number) {
  const NiftiFiles files = find_files(path);
  auto file = std::make_shared<GzFile>(files.header);
  const NiftiHeader header = read_nifti_header(*file, path);
  if (!header.single_file && files.header == files.voxels) {
    throw_bad_volume(path, "the header of a pair, without voxels, under a single-file name",
                     "rename it .hdr and put the .img beside it");
  }
  VolumeSource source;
  VolumeHeader& out = source.header;
  out.format = header.version == 0 ? "Analyze 7.5" : header.version == 1 ? "NIfTI-1" : "NIfTI-2";
  const Index3 size = size_of(header, frame_number.has_value(), path);
  if (frame_number) take_frames(header, *frame_number, path, out);
  const ComponentType type = component_of(header, path);
  out.component_type = name_of(type);
  const NiftiFrame frame = frame_of(header);
  out.unit = unit_name(frame.xyzt_units);
  out.grid = grid_of(frame, header.version == 0, size, path, out);
  if (header.version > 0) out.nifti = std::make_shared<const NiftiFrame>(frame);
  take_scaling(header, out);

  const std::uint64_t offset = voxel_offset(header, path);
  const std::size_t count = out.grid.voxel_count();
  if (!header.single_file) file = std::make_shared<GzFile>(files.voxels);
  const std::uint64_t volume_bytes = static_cast<std::uint64_t>(count) * size_in_bytes(type);
  check_claim(path, offset + static_cast<std::uint64_t>(out.frames) * volume_bytes, file->bytes_on_disk(),
              file->compressed());
  if (has_suffix(path, ".gz") && !file->compressed())
    out.warnings.emplace_back("The file is named .gz but is not gzipped.");
  const std::uint64_t already = header.single_file ? (header.version == 2 ? 540U : 348U) : 0U;
  const std::uint64_t earlier = static_cast<std::uint64_t>(frame_number.value_or(0)) * volume_bytes;
  source.read_blocks = [file, offset, already, earlier, type, count, swapped = header.swapped](const auto& consume) {
    file->skip(offset - already + earlier);
    stream_voxels(*file, type, swapped, count, consume);
  };
  return source;
}

}  // namespace pellicle
