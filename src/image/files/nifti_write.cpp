#include <fmt/format.h>
#include <nifti2_io.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "pellicle/base/atomic_file.h"
#include "pellicle/base/errors.h"
#include "pellicle/image/files/internal/nifti_frame.h"
#include "pellicle/image/files/volume_file.h"

namespace pellicle {
namespace fs = std::filesystem;

namespace {

template <class T>
struct NiftiType;
template <>
struct NiftiType<std::uint8_t> {
  static constexpr int code = DT_UINT8;
};
template <>
struct NiftiType<std::uint16_t> {
  static constexpr int code = DT_UINT16;
};
template <>
struct NiftiType<std::int16_t> {
  static constexpr int code = DT_INT16;
};
template <>
struct NiftiType<std::int32_t> {
  static constexpr int code = DT_INT32;
};
template <>
struct NiftiType<float> {
  static constexpr int code = DT_FLOAT32;
};

// The frame of a grid that came from another format: qform and sform the same, scanner coordinates in mm.
NiftiFrame frame_of_grid(const ImageGrid& grid) {
  const Mat3 flip = Vec3(-1, -1, 1).asDiagonal();
  const Mat3 ras = flip * grid.world_from_index_matrix();
  const Vec3 origin = flip_lps_ras(grid.origin_in_world);
  NiftiFrame frame;
  frame.qform_code = frame.sform_code = NIFTI_XFORM_SCANNER_ANAT;
  frame.xyzt_units = NIFTI_UNITS_MM;
  nifti_dmat44 m{};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      m.m[row][column] = ras(row, column) + 0.0;  // no negative zeros
      frame.srow[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] = m.m[row][column];
    }
    m.m[row][3] = origin[row] + 0.0;
    frame.srow[static_cast<std::size_t>(row)][3] = m.m[row][3];
    frame.qoffset[static_cast<std::size_t>(row)] = m.m[row][3];
    frame.pixdim[static_cast<std::size_t>(row) + 1] = grid.spacing[row];
  }
  m.m[3][3] = 1.0;
  double ignored = 0.0;
  nifti_dmat44_to_quatern(m, &frame.quatern[0], &frame.quatern[1], &frame.quatern[2], &ignored, &ignored, &ignored,
                          &ignored, &ignored, &ignored, &frame.pixdim[0]);
  return frame;
}

bool exact_as_float(double value) {
  return !std::isfinite(value) || static_cast<double>(static_cast<float>(value)) == value;
}

// NIfTI-1 unless it cannot hold the size, or would round a frame that was stored in double.
bool needs_nifti_2(const NiftiFrame& frame, const Index3& size) {
  if (*std::max_element(size.begin(), size.end()) > std::numeric_limits<std::int16_t>::max()) return true;
  if (frame.version != 2) return false;
  bool exact = std::all_of(frame.pixdim.begin(), frame.pixdim.end(), exact_as_float) &&
               std::all_of(frame.quatern.begin(), frame.quatern.end(), exact_as_float) &&
               std::all_of(frame.qoffset.begin(), frame.qoffset.end(), exact_as_float);
  for (const auto& row : frame.srow) exact = exact && std::all_of(row.begin(), row.end(), exact_as_float);
  return !exact;
}

// Fills what both header versions have; the narrowing to float is the identity for a NIfTI-1 frame.
template <class Header>
Header header_of(const NiftiFrame& frame, const Index3& size, int type_code, std::size_t width) {
  Header h{};
  h.sizeof_hdr = static_cast<int>(sizeof(Header));
  std::fill(std::begin(h.dim), std::end(h.dim), 1);
  h.dim[0] = 3;
  for (std::size_t axis = 0; axis < 3; ++axis) h.dim[axis + 1] = static_cast<std::int16_t>(size[axis]);
  h.datatype = static_cast<std::int16_t>(type_code);
  h.bitpix = static_cast<std::int16_t>(8 * width);
  using Real = std::remove_reference_t<decltype(h.quatern_b)>;
  const auto real = [](double value) { return static_cast<Real>(value); };
  std::fill(std::begin(h.pixdim), std::end(h.pixdim), Real{0});
  std::transform(frame.pixdim.begin(), frame.pixdim.end(), std::begin(h.pixdim), real);
  h.scl_slope = 1;
  h.scl_inter = 0;
  h.xyzt_units = static_cast<decltype(h.xyzt_units)>(XYZT_TO_SPACE(frame.xyzt_units));
  h.qform_code = static_cast<std::int16_t>(frame.qform_code);
  h.sform_code = static_cast<std::int16_t>(frame.sform_code);
  h.quatern_b = real(frame.quatern[0]);
  h.quatern_c = real(frame.quatern[1]);
  h.quatern_d = real(frame.quatern[2]);
  h.qoffset_x = real(frame.qoffset[0]);
  h.qoffset_y = real(frame.qoffset[1]);
  h.qoffset_z = real(frame.qoffset[2]);
  std::transform(frame.srow[0].begin(), frame.srow[0].end(), std::begin(h.srow_x), real);
  std::transform(frame.srow[1].begin(), frame.srow[1].end(), std::begin(h.srow_y), real);
  std::transform(frame.srow[2].begin(), frame.srow[2].end(), std::begin(h.srow_z), real);
  return h;
}

std::vector<char> header_bytes(const NiftiFrame& frame, const Index3& size, int type_code, std::size_t width) {
  if (needs_nifti_2(frame, size)) {
    auto h = header_of<nifti_2_header>(frame, size, type_code, width);
    for (std::size_t axis = 0; axis < 3; ++axis) h.dim[axis + 1] = size[axis];
    std::memcpy(h.magic, "n+2\0\r\n\032\n", 8);
    h.vox_offset = 544;
    std::vector<char> bytes(544, 0);
    std::memcpy(bytes.data(), &h, sizeof h);
    return bytes;
  }
  auto h = header_of<nifti_1_header>(frame, size, type_code, width);
  h.regular = 'r';
  std::memcpy(h.magic, "n+1", 4);
  h.vox_offset = 352;
  std::vector<char> bytes(352, 0);
  std::memcpy(bytes.data(), &h, sizeof h);
  return bytes;
}

class GzWriter {
 public:
  GzWriter(const fs::path& path, const fs::path& final_path, bool compress) : final_(final_path) {
    // Level 1: a mask is nearly free of entropy, and writing is part of every run's time. T = plain bytes.
    file_ = gzopen(path.c_str(), compress ? "wb1" : "wbT");
    if (file_ == nullptr)
      throw CannotCreate(fmt::format("cannot create output ({}): {}", final_.string(), std::strerror(errno)));
    gzbuffer(file_, 1U << 18);
  }
  ~GzWriter() {
    if (file_ != nullptr) gzclose(file_);
  }
  GzWriter(const GzWriter&) = delete;
  GzWriter& operator=(const GzWriter&) = delete;

  void write(const void* data, std::size_t count) {
    constexpr std::size_t most = 1U << 26;
    for (std::size_t done = 0; done < count;) {
      const auto step = static_cast<unsigned>(std::min(most, count - done));
      if (gzwrite(file_, static_cast<const char*>(data) + done, step) != static_cast<int>(step)) fail();
      done += step;
    }
  }
  void close() {
    const int code = gzclose(file_);
    file_ = nullptr;
    if (code != Z_OK) fail();
  }

 private:
  [[noreturn]] void fail() const {
    throw IoError(fmt::format("writing failed ({}): {}", final_.string(), std::strerror(errno)));
  }

  gzFile file_ = nullptr;
  fs::path final_;
};

}  // namespace

template <class T>
void write_volume(const fs::path& path, const Image<T>& image, const VolumeHeader& like) {
  if (image.grid.size != like.grid.size || image.voxels.size() != like.grid.voxel_count()) {
    throw std::invalid_argument("write_volume: the image and the header that it is to be like differ in size");
  }
  const std::string name = path.string();
  const bool compress = name.ends_with(".nii.gz");
  if (!compress && !name.ends_with(".nii")) {
    throw CannotCreate(
        fmt::format("cannot create output ({}): volumes are written as NIfTI; name it .nii or .nii.gz", name));
  }
  AtomicFile file(path);
  GzWriter writer(file.path(), path, compress);
  const NiftiFrame frame = like.nifti ? *like.nifti : frame_of_grid(like.grid);
  const std::vector<char> header = header_bytes(frame, like.grid.size, NiftiType<T>::code, sizeof(T));
  writer.write(header.data(), header.size());
  writer.write(image.voxels.data(), image.voxels.size() * sizeof(T));
  writer.close();
  file.commit();
}

template void write_volume(const fs::path&, const Image<std::uint8_t>&, const VolumeHeader&);
template void write_volume(const fs::path&, const Image<std::uint16_t>&, const VolumeHeader&);
template void write_volume(const fs::path&, const Image<std::int16_t>&, const VolumeHeader&);
template void write_volume(const fs::path&, const Image<std::int32_t>&, const VolumeHeader&);
template void write_volume(const fs::path&, const Image<float>&, const VolumeHeader&);

}  // namespace pellicle
