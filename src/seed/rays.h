#pragma once
/// What rays from a seed's centre see: the first clear edge in every direction, and an ellipsoid through them.

#include "pellicle/seed/seed.h"

namespace pellicle {

/// The reading of the rays for one sign of contrast (+1 bright object, -1 dark) or for a membrane.
struct RayReading {
  double sign = 1.0;
  bool ridge = false;
  double inside = 0.0,
         outside = 0.0;  ///< medians over rays of the levels 2.5 h before and after the edge (ridge: top, sides)
  double score = 0.0;    ///< larger is more credible; comparable between readings of one seed
  Vec3 center{0, 0, 0};  ///< of the star-shaped body that the rays outline
  Mat3 shape = Mat3::Identity();  ///< unit ball -> moment ellipsoid of that body; columns: half-axes in mm
  double median_radius = 0.0;     ///< mm
};

/// 256 rays from the seed's centre, image smoothed by one voxel across and along the ray. Readings for a bright object,
/// a dark one and a membrane, in this order; those without an edge in a quarter of the directions have score 0.
/// \param h length scale of the edges looked for, mm (cube root of the voxel volume).
std::vector<RayReading> read_rays(const Image<float>& smoothed, const SeedSphere& seed, double h);

/// Robust level and spread of the image in the core of a seed: the ball of radius max(fraction R, 1.6 h) about its
/// centre.
struct CoreStatistics {
  double median = 0.0, deviation = 0.0;
  int voxels = 0;
};
CoreStatistics core_statistics(const Image<float>& image, const SeedSphere& seed, double fraction);

}  // namespace pellicle
