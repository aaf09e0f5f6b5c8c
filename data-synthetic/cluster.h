#pragma once
/// Many nuclei in one volume, with exact truth for each: random ellipsoids, apart or touching. Where two overlap their
/// intensities add up.

#include <cstdint>
#include <string>
#include <vector>

#include "pellicle/synthetic/phantom.h"

namespace pellicle {

struct ClusterSettings {
  /// Grid, intensities, blur, noise, bias and random seed; its shape, radius, centre and fill are not used.
  PhantomSettings image;
  int count = 40;
  double radius_min = 5.0, radius_max = 8.0;      ///< of the ball of equal volume, mm, uniform
  double elongation = 1.3;                        ///< largest half axis ratio, >= 1
  double distance = 1.0;                          ///< centres of two objects are at least distance (r + r') apart
  double contrast_min = 1.0, contrast_max = 1.0;  ///< contrast of an object, log-uniform, relative to the image's

  /// \throws SettingError with the key, its value and the rule.
  void validate() const;
};

struct Cluster {
  ClusterSettings settings;
  Image<float> image;
  Image<std::uint16_t> truth;  ///< label i + 1 for bodies[i]; where two overlap, the one the voxel is deeper in
  std::vector<Body> bodies;
  std::vector<double> contrast;  ///< relative, of each body
  std::vector<SeedDraw> seeds;   ///< one for each body, drawn as those of the other phantoms
};

/// \throws UsageError: see validate(), and when the objects do not fit into the volume. Same bytes for any number of
///         threads.
Cluster make_cluster(const ClusterSettings& settings);

/// The `STEM_truth.json` of a cluster: every object with its label, exact volume, axes and seed, and every setting.
std::string truth_json(const Cluster& cluster);

}  // namespace pellicle
