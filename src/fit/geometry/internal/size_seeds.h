#pragma once
/// Start surfaces of a fit to geometry from voxels of the solid that the data enclose, coarse to fine.

#include <memory>
#include <optional>
#include <vector>

#include "pellicle/base/observer.h"
#include "pellicle/fit/geometry/geometry_input.h"
#include "pellicle/mesh/points/point_tree.h"
#include "pellicle/seed/voxel_seed.h"

namespace pellicle {

class SizeSeeds {
 public:
  /// \param input kept by reference.
  /// \param smoothness factor of the bending energy.
  SizeSeeds(const GeometryInput& input, const ModelChoice& model, double smoothness, const Observer& observer)
      : input_(input), model_(model), smoothness_(smoothness), observer_(observer) {}

  /// The coarsest grid first, each finer by a root of two: twice the control points. None when the voxels would be
  /// finer than the body's.
  std::optional<VoxelSeed> next();
  /// mm, of the last grid.
  double spacing() const { return spacing_; }
  /// Voxels of the genus of the data that cover the body's surface best. Thin limbs are followed. Several fractions of
  /// a voxel that must be filled are tried: larger ones keep near sheets apart. None when no fraction shows the genus.
  std::optional<VoxelSeed> on_grid(double spacing);

  /// The seed fitted to the whole surface of the body, so that limbs are in their place before the points pull. That
  /// shape becomes the reference of the bending energy: measured against voxels it would keep their corners. Of open
  /// data the part along the points (seed/open_seed.h).
  Surface surface_on(const VoxelSeed& seed);
  /// The first of next(); when no grid shows the genus, that of the body's own voxels.
  Surface first();

 private:
  double uncovered_fraction(const VoxelSeed& seed);

  const GeometryInput& input_;
  ModelChoice model_;
  double smoothness_;
  const Observer& observer_;
  std::optional<GeometryData> body_data_;  ///< the body's surface
  std::vector<Vec3> body_points_;          ///< on the surface of the body
  std::unique_ptr<PointTree> tree_;        ///< of open data
  std::vector<Vec3> plane_normals_;        ///< of open data
  double spacing_ = 0.0;
};

}  // namespace pellicle
