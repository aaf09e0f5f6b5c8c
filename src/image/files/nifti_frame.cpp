#include "pellicle/image/files/internal/nifti_frame.h"

#include <fmt/format.h>
#include <nifti2_io.h>

#include <algorithm>
#include <cmath>

#include "pellicle/image/files/internal/affine_grid.h"
#include "pellicle/image/files/internal/bad_volume.h"

namespace pellicle {
namespace {

struct Affine {
  Mat3 matrix;
  Vec3 origin;
};

// RAS in the file's unit -> LPS mm.
Affine to_lps_mm(const Mat3& matrix, const Vec3& origin, double mm) {
  const Vec3 flip(-mm, -mm, mm);
  // Adding zero turns the negative zeros of the flip into plain ones.
  return {flip.asDiagonal() * matrix, flip.cwiseProduct(origin) + Vec3::Zero()};
}

Affine sform_affine(const NiftiFrame& frame, double mm) {
  Mat3 matrix;
  Vec3 origin;
  for (int row = 0; row < 3; ++row) {
    const auto& stored = frame.srow[static_cast<std::size_t>(row)];
    matrix.row(row) << stored[0], stored[1], stored[2];
    origin[row] = stored[3];
  }
  return to_lps_mm(matrix, origin, mm);
}

Affine qform_affine(const NiftiFrame& frame, const Vec3& spacing_in_unit, double mm) {
  const nifti_dmat44 q = nifti_quatern_to_dmat44(frame.quatern[0], frame.quatern[1], frame.quatern[2], 0.0, 0.0, 0.0,
                                                 1.0, 1.0, 1.0, frame.pixdim[0] < 0.0 ? -1.0 : 1.0);
  Mat3 rotation;
  for (int row = 0; row < 3; ++row) rotation.row(row) << q.m[row][0], q.m[row][1], q.m[row][2];
  return to_lps_mm(rotation * spacing_in_unit.asDiagonal(), Vec3(frame.qoffset[0], frame.qoffset[1], frame.qoffset[2]),
                   mm);
}

// pixdim in the file's unit. The sform carries its own spacing, so that only the other placements complain.
Vec3 pixdim_spacing(const NiftiFrame& frame, VolumeHeader& header) {
  Vec3 spacing;
  for (int axis = 0; axis < 3; ++axis) {
    const double stored = frame.pixdim[static_cast<std::size_t>(axis) + 1];
    spacing[axis] = std::abs(stored);
    if (!std::isfinite(stored) || stored == 0.0) {
      spacing[axis] = 1.0 / mm_per_unit(frame.xyzt_units);
      header.spacing_known = false;
      header.warnings.push_back(fmt::format(
          "NO SPACING along axis {} (pixdim is {}): 1 mm is assumed; set it with `spacing`.", axis, stored));
    } else if (stored < 0.0) {
      header.warnings.push_back(
          fmt::format("The spacing along axis {} is stored as {}; its absolute value is used.", axis, stored));
    }
  }
  return spacing;
}

double farthest_corner_distance(const Affine& a, const Affine& b, const Index3& size) {
  double largest = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 index;
    for (int axis = 0; axis < 3; ++axis) {
      index[axis] = (corner >> axis & 1) != 0 ? size[static_cast<std::size_t>(axis)] - 1 : 0;
    }
    largest = std::max(largest, ((a.matrix - b.matrix) * index + a.origin - b.origin).norm());
  }
  return largest;
}

bool is_rectangular(const Affine& affine) {
  const double skew = skew_degrees(affine.matrix);
  return affine.matrix.allFinite() && affine.origin.allFinite() && skew <= max_skew_degrees;
}

}  // namespace

double mm_per_unit(int xyzt_units) {
  switch (XYZT_TO_SPACE(xyzt_units)) {
    case NIFTI_UNITS_UNKNOWN:
    case NIFTI_UNITS_MM:
      return 1.0;
    case NIFTI_UNITS_METER:
      return 1e3;
    case NIFTI_UNITS_MICRON:
      return 1e-3;
    default:
      return 0.0;
  }
}

std::string unit_name(int xyzt_units) {
  switch (XYZT_TO_SPACE(xyzt_units)) {
    case NIFTI_UNITS_MM:
      return "mm";
    case NIFTI_UNITS_METER:
      return "m";
    case NIFTI_UNITS_MICRON:
      return "um";
    default:
      return "unknown";
  }
}

ImageGrid grid_of(const NiftiFrame& frame, bool analyze, const Index3& size, const std::filesystem::path& path,
                  VolumeHeader& header) {
  double mm = mm_per_unit(frame.xyzt_units);
  if (mm == 0.0) {
    header.warnings.push_back(
        fmt::format("The unit of length (code {}) is not known; mm is assumed.", frame.xyzt_units & 7));
    mm = 1.0;
  }
  const bool has_sform = !analyze && frame.sform_code > 0, has_qform = !analyze && frame.qform_code > 0;
  if (!has_sform && !has_qform) {
    const Vec3 spacing = pixdim_spacing(frame, header) * mm;
    header.warnings.push_back(
        fmt::format("The file does not say how it lies in space ({}): index axes are taken as left, "
                    "posterior, superior, so that left and right are not certain.",
                    analyze ? "Analyze 7.5" : "no sform, no qform"));
    return grid_from_affine(path, size, spacing.asDiagonal(), Vec3::Zero(), header.warnings);
  }
  if (!has_sform) {
    const Affine qform = qform_affine(frame, pixdim_spacing(frame, header), mm);
    return grid_from_affine(path, size, qform.matrix, qform.origin, header.warnings);
  }
  const Affine sform = sform_affine(frame, mm);
  if (has_qform) {
    VolumeHeader of_qform;  // its complaints matter only when it is chosen
    const Affine qform = qform_affine(frame, pixdim_spacing(frame, of_qform), mm);
    const double apart = farthest_corner_distance(sform, qform, size);
    // A twentieth of a voxel: headers are written with rounded numbers.
    const double tolerance = 0.05 * qform.matrix.colwise().norm().minCoeff();
    const bool sheared = !is_rectangular(sform);
    if (is_rectangular(qform) && (sheared || (frame.sform_code != NIFTI_XFORM_SCANNER_ANAT && !(apart <= tolerance)))) {
      header.warnings.insert(header.warnings.end(), of_qform.warnings.begin(), of_qform.warnings.end());
      header.spacing_known = of_qform.spacing_known;
      header.warnings.push_back(
          sheared ? "The sform is singular or sheared; the qform is used instead."
                  : fmt::format("sform (code {}) and qform (code {}) disagree by up to {:.3g} mm; the qform is used.",
                                frame.sform_code, frame.qform_code, apart));
      return grid_from_affine(path, size, qform.matrix, qform.origin, header.warnings);
    }
    if (!(apart <= tolerance)) {
      header.warnings.push_back(
          fmt::format("sform (code {}) and qform (code {}) disagree by up to {:.3g} mm; the sform is used.",
                      frame.sform_code, frame.qform_code, apart));
    }
  }
  return grid_from_affine(path, size, sform.matrix, sform.origin, header.warnings);
}

}  // namespace pellicle
