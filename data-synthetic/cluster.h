#pragma once
/// Many nuclei in one volume, with exact truth for each: random ellipsoids, apart or touching. Where two overlap their
/// intensities add up.

#include <cstdint>
#include <vector>

#include "pellicle/synthetic/phantom.h"

namespace pellicle {

struct ClusterSettings {
  /// Grid, intensities, blur, noise, bias and random seed; its shape, radius, centre and fill are not used.
  PhantomSettings image;
  int count = 40;
  double radius_min = 5.0, radius_max = 8.0;  ///< of the ball of equal volume, mm, uniform
  double elongation = 1.3;                    ///< largest half axis ratio, >= 1
  double distance = 1.0;                      ///< centres of two objects are at least distance (r + r') apart
  double contrast_min = 1.0;                  ///< contrast of an object: log-uniform in [contrast_min, 1], relative
};

struct Cluster {
  Image<float> image;
  Image<std::uint16_t> truth;  ///< label i + 1 for bodies[i]; where two overlap, the one the voxel is deeper in
  std::vector<Body> bodies;
  std::vector<double> contrast;  ///< relative, of each body
};

/// \throws UsageError when the objects do not fit into the volume. Same bytes for any number of threads.
Cluster make_cluster(const ClusterSettings& settings);

}  // namespace pellicle
