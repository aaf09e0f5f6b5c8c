#include "pellicle/image/files/internal/nifti_header.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string_view>

namespace pellicle {
namespace {

constexpr int nifti_1_size = 348, nifti_2_size = 540;

template <std::size_t N, class T>
void widen(const T (&from)[N], double (&to)[N]) {
  std::copy(std::begin(from), std::end(from), std::begin(to));
}

// A float of a damaged header may hold anything; a cast of what does not fit would be undefined.
std::int64_t whole_offset(float value) {
  return std::isfinite(value) && std::abs(value) < 1e15F ? std::llround(value) : -1;
}

nifti_2_header widened(const nifti_1_header& h) {
  nifti_2_header w{};
  w.sizeof_hdr = nifti_2_size;
  w.datatype = h.datatype;
  w.bitpix = h.bitpix;
  std::copy(std::begin(h.dim), std::end(h.dim), std::begin(w.dim));
  widen(h.pixdim, w.pixdim);
  w.vox_offset = whole_offset(h.vox_offset);
  w.scl_slope = h.scl_slope;
  w.scl_inter = h.scl_inter;
  w.qform_code = h.qform_code;
  w.sform_code = h.sform_code;
  w.quatern_b = h.quatern_b;
  w.quatern_c = h.quatern_c;
  w.quatern_d = h.quatern_d;
  w.qoffset_x = h.qoffset_x;
  w.qoffset_y = h.qoffset_y;
  w.qoffset_z = h.qoffset_z;
  widen(h.srow_x, w.srow_x);
  widen(h.srow_y, w.srow_y);
  widen(h.srow_z, w.srow_z);
  w.xyzt_units = static_cast<unsigned char>(h.xyzt_units);
  w.intent_code = h.intent_code;
  return w;
}

nifti_2_header widened_analyze(const nifti_1_header& h) {
  nifti_2_header
      w{};  // most of what NIfTI uses means something else in Analyze: only size, type and spacing are shared
  w.sizeof_hdr = nifti_2_size;
  w.datatype = h.datatype;
  w.bitpix = h.bitpix;
  std::copy(std::begin(h.dim), std::end(h.dim), std::begin(w.dim));
  widen(h.pixdim, w.pixdim);
  w.vox_offset = std::max<std::int64_t>(0, whole_offset(h.vox_offset));
  return w;
}

}  // namespace

NiftiHeader read_nifti_header(GzFile& file, const std::filesystem::path& path) {
  const char* not_nifti = "not a NIfTI or Analyze file (no such header)";
  const char* hint = "check that the file is what its name says";
  NiftiHeader header;
  std::array<char, nifti_2_size> bytes{};
  if (file.read_some(bytes.data(), nifti_1_size) < nifti_1_size) throw_bad_volume(path, not_nifti, hint);
  std::int32_t claimed = 0;
  std::memcpy(&claimed, bytes.data(), sizeof claimed);
  std::int32_t turned = claimed;
  nifti_swap_Nbytes(1, sizeof turned, &turned);
  header.swapped = turned == nifti_1_size || turned == nifti_2_size;
  const std::int32_t size = header.swapped ? turned : claimed;

  if (size == nifti_2_size) {
    file.read_exact(bytes.data() + nifti_1_size, nifti_2_size - nifti_1_size);
    std::memcpy(&header.fields, bytes.data(), nifti_2_size);
    if (header.swapped) nifti_swap_as_nifti2(&header.fields);
    header.version = 2;
    header.single_file = header.fields.magic[1] == '+';
    if (std::string_view(header.fields.magic, 3) != (header.single_file ? "n+2" : "ni2"))
      throw_bad_volume(path, not_nifti, hint);
    return header;
  }
  if (size != nifti_1_size) throw_bad_volume(path, not_nifti, hint);
  nifti_1_header first{};
  std::memcpy(&first, bytes.data(), nifti_1_size);
  header.version = std::memcmp(first.magic, "n+1", 4) == 0 || std::memcmp(first.magic, "ni1", 4) == 0 ? 1 : 0;
  header.single_file = header.version == 1 && first.magic[1] == '+';
  // The Analyze swap covers the fields that are used here: its sizes, types, dim and pixdim are those of NIfTI.
  if (header.swapped) nifti_swap_as_nifti1(&first);
  header.fields = header.version == 1 ? widened(first) : widened_analyze(first);
  return header;
}

NiftiFrame frame_of(const NiftiHeader& header) {
  const nifti_2_header& h = header.fields;
  NiftiFrame frame;
  frame.version = header.version;
  frame.qform_code = h.qform_code;
  frame.sform_code = h.sform_code;
  frame.xyzt_units = h.xyzt_units;
  std::copy_n(std::begin(h.pixdim), 4, frame.pixdim.begin());
  frame.quatern = {h.quatern_b, h.quatern_c, h.quatern_d};
  frame.qoffset = {h.qoffset_x, h.qoffset_y, h.qoffset_z};
  std::copy(std::begin(h.srow_x), std::end(h.srow_x), frame.srow[0].begin());
  std::copy(std::begin(h.srow_y), std::end(h.srow_y), frame.srow[1].begin());
  std::copy(std::begin(h.srow_z), std::end(h.srow_z), frame.srow[2].begin());
  return frame;
}

}  // namespace pellicle
