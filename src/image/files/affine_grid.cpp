#include "pellicle/image/files/internal/affine_grid.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "pellicle/image/files/internal/bad_volume.h"

namespace pellicle {
namespace {

constexpr double silent_skew_degrees = 0.01;

bool is_singular(const Mat3& m) {
  const Vec3 length = m.colwise().norm();
  if (!m.allFinite() || !(length.minCoeff() > 0.0)) return true;
  const Mat3 unit = m * length.cwiseInverse().asDiagonal();
  return !(std::abs(unit.determinant()) > 1e-6);
}

// How far the replacement moves the voxel that it moves most, mm.
double largest_move(const Index3& size, const Mat3& before, const Mat3& after) {
  double largest = 0.0;
  for (int corner = 1; corner < 8; ++corner) {
    Vec3 index;
    for (int axis = 0; axis < 3; ++axis) {
      index[axis] = (corner >> axis & 1) != 0 ? size[static_cast<std::size_t>(axis)] - 1 : 0;
    }
    largest = std::max(largest, ((after - before) * index).norm());
  }
  return largest;
}

}  // namespace

double skew_degrees(const Mat3& world_from_index) {
  const Vec3 length = world_from_index.colwise().norm();
  if (!(length.minCoeff() > 0.0)) return std::numeric_limits<double>::quiet_NaN();
  const Mat3 unit = world_from_index * length.cwiseInverse().asDiagonal();
  const double cosine = std::max({std::abs(unit.col(0).dot(unit.col(1))), std::abs(unit.col(0).dot(unit.col(2))),
                                  std::abs(unit.col(1).dot(unit.col(2)))});
  return std::asin(std::min(1.0, cosine)) * 180.0 / std::numbers::pi;
}

Mat3 nearest_rotation(const Mat3& m) {
  Mat3 x = m;
  for (int iteration = 0; iteration < 50; ++iteration) {
    const Mat3 next = 0.5 * (x + x.inverse().transpose());
    const double change = (next - x).norm();
    x = next;
    if (!(change > 1e-15)) break;
  }
  return x;
}

ImageGrid grid_from_affine(const std::filesystem::path& path, const Index3& size, const Mat3& world_from_index,
                           const Vec3& origin_in_world, std::vector<std::string>& warnings) {
  if (is_singular(world_from_index) || !origin_in_world.allFinite()) {
    throw_bad_volume(path, "the orientation matrix is singular or not finite, so that voxels have no place in space",
                     "repair the header");
  }
  ImageGrid grid;
  grid.size = size;
  grid.origin_in_world = origin_in_world;
  grid.spacing = world_from_index.colwise().norm();
  const double skew = skew_degrees(world_from_index);
  if (!(skew <= max_skew_degrees)) {
    throw_bad_volume(path,
                     fmt::format("the orientation matrix is sheared: index axes are {:.2f} degrees off a right angle, "
                                 "at most {} can be read",
                                 skew, max_skew_degrees),
                     "resample the volume onto a rectangular grid first");
  }
  grid.direction = nearest_rotation(world_from_index * grid.spacing.cwiseInverse().asDiagonal());
  if (skew > silent_skew_degrees) {
    warnings.push_back(
        fmt::format("The index axes are {:.3f} degrees off a right angle; the nearest rotation is used, which moves "
                    "voxels by up to {:.3g} mm.",
                    skew, largest_move(size, world_from_index, grid.world_from_index_matrix())));
  }
  if (grid.spacing.minCoeff() < 1e-5 || grid.spacing.maxCoeff() > 1e3) {
    warnings.push_back(fmt::format(
        "The spacing of {:.4g} x {:.4g} x {:.4g} mm is implausible; check the unit or set it with `spacing`.",
        grid.spacing[0], grid.spacing[1], grid.spacing[2]));
  }
  return grid;
}

}  // namespace pellicle
