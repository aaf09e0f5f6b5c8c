#pragma once
/// Start surfaces of `pellicle fit` from voxels of the body of the data, coarse to fine. For this folder's sources
/// only.

#include <memory>
#include <optional>
#include <vector>

#include "pellicle/output/fit_points.h"
#include "pellicle/seed/open_seed.h"
#include "pellicle/seed/voxel_seed.h"

namespace pellicle {

class FitSeeds {
 public:
  /// Both are kept by reference.
  FitSeeds(const GeometryInput& input, const GeometryFitSettings& settings) : input_(input), settings_(settings) {}

  /// The coarsest grid first, each finer by a root of two: twice the control points. None when the voxels would be
  /// finer than the body's.
  std::optional<VoxelSeed> next();
  /// mm, of the last grid.
  double spacing() const { return spacing_; }
  /// Voxels of the genus of the data that reach all of them, or those that miss least. Thin limbs are followed; what
  /// must fill more of a voxel keeps near sheets apart. None when no share shows the genus.
  std::optional<VoxelSeed> on_grid(double spacing);

  /// Drawn to the body's whole surface, which has no gaps and an outside: limbs are in their place before the points
  /// pull. That shape is then the one at rest: bending measured against voxels would keep their corners. Of open data
  /// the part along the points (seed/open_seed.h).
  Surface surface_on(const VoxelSeed& seed);
  /// When no grid shows the genus, the body's own does as well as it can.
  Surface first();

 private:
  double missed_by(const VoxelSeed& seed);

  const GeometryInput& input_;
  const GeometryFitSettings& settings_;
  std::optional<GeometryData> body_data_;  ///< the body's surface
  std::vector<Vec3> body_points_;          ///< on the surface of the body
  std::unique_ptr<PointTree> tree_;        ///< of open data
  std::vector<Vec3> plane_normals_;        ///< of open data
  double spacing_ = 0.0;
};

}  // namespace pellicle
