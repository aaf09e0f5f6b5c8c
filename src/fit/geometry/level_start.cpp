// Where a level starts and how stiff it is.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "pellicle/energies/bending.h"
#include "pellicle/energies/geometry.h"
#include "pellicle/fit/geometry/level_fit.h"
#include "pellicle/mesh/measure.h"

namespace pellicle {

namespace {

/// Ellipsoid-like start: least-squares affine map from the reference shape to the targets.
Parameters affine_start(const SurfaceModel& model, const SampleLayout& layout, const std::vector<Vec3>& targets,
                        const std::vector<double>& area) {
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Matrix<double, 4, 3> right = Eigen::Matrix<double, 4, 3>::Zero();
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const Eigen::Vector4d r(layout.reference[i].x(), layout.reference[i].y(), layout.reference[i].z(), 1.0);
    normal += area[i] * r * r.transpose();
    right += area[i] * r * targets[i].transpose();
  }
  const Eigen::Matrix<double, 4, 3> solution = normal.ldlt().solve(right);
  const Mat3 A = solution.topRows<3>().transpose();
  const Vec3 centre = solution.row(3).transpose();
  // A map that folds (limbs may do that) tells no normals: then a ball of the same size.
  const double size = std::cbrt(std::abs(A.determinant()));
  const Eigen::JacobiSVD<Mat3> svd(A);
  const bool sound = A.determinant() > 0.0 && svd.singularValues()[2] > 0.05 * svd.singularValues()[0];
  return affine_image(model, centre,
                      sound ? A : Mat3(std::max(size, 0.2 * svd.singularValues()[0]) * Mat3::Identity()));
}

}  // namespace

double bending_weight(const SurfaceModel& model) {
  const double degree2 = 0.25 * control_point_count(model);
  return 0.02 * bending_scale(model) / (degree2 * degree2);
}

CoarseBending coarse_bending(const SurfaceModel& model, const SampleLayout& layout) {
  int level = 0;
  while (level < layout.level && control_point_count(model) * std::pow(4.0, level) < 600.0) ++level;
  if (level == layout.level) return {bending_rows(layout), {}};
  const SampleLayout coarse = knot_layout_of(model, level);
  CoarseBending out{bending_rows(coarse), samples_of_coarser(layout, coarse)};
  if (out.samples.empty()) return {bending_rows(layout), {}};
  for (int& s : out.rows.sample) s = out.samples[static_cast<std::size_t>(s)];
  return out;
}

std::vector<Vec3> targets_at(const SampleLayout& layout, const SphereMap& map, const Mat3& map_from_reference) {
  const SphereLocator locator(map);
  std::vector<Vec3> targets;
  targets.reserve(layout.reference.size());
  int hint = -1;
  for (const Vec3& r : layout.reference) {
    const auto place = locator.locate(map_from_reference * r, hint);
    hint = place.triangle;
    targets.push_back(locator.point_at(place));
  }
  return targets;
}

Parameters start_at_targets(const SurfaceModel& model, const SampleLayout& layout, const std::vector<Vec3>& targets) {
  Parameters parameters = affine_start(model, layout, targets, sample_areas(layout, targets));
  place_on(model, layout, {targets, area_vectors(layout, targets)}, parameters);
  return parameters;
}

}  // namespace pellicle
