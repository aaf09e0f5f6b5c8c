#include "pellicle/mask/moments.h"

#include <Eigen/Eigenvalues>

namespace pellicle {

Moments moments_of(const Image<std::uint8_t>& mask) {
  double count = 0.0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  const Index3& size = mask.grid.size;
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i) {
        if (mask.at(i, j, k) == 0) continue;
        const Vec3 v(i, j, k);
        count += 1.0;
        first += v;
        second += v * v.transpose();
      }
    }
  }
  const Vec3 mean = first / count;
  // Variance of the voxels themselves (1/12 along each axis) belongs to the solid.
  const Mat3 in_index = second / count - mean * mean.transpose() + Mat3::Identity() / 12.0;
  const Mat3 to_world = mask.grid.world_from_index_matrix();
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(to_world * in_index * to_world.transpose());
  const Vec3 axes = (5.0 * eigen.eigenvalues().cwiseMax(1e-12)).cwiseSqrt();
  return {mask.grid.world_from_index(mean), eigen.eigenvectors() * axes.asDiagonal() * eigen.eigenvectors().transpose(),
          count * mask.grid.voxel_volume()};
}

}  // namespace pellicle
