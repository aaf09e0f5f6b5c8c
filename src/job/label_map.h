#pragma once
/// Voxel maps of fitted surfaces: whose voxel is it, how much of it lies inside, how far off the surface is it.

#include <cstdint>
#include <vector>

#include "pellicle/job/segment_options.h"
#include "pellicle/job/segmentation.h"

namespace pellicle {

/// Labels and inside fractions of all objects.
struct VoxelMaps {
  Image<std::uint16_t> labels;
  Image<float> fraction;  ///< 0..1; empty unless the options ask for it
};

/// Marks the voxels of each object. A voxel inside several surfaces goes to the one in which it is deepest for its size
/// (raster/joint_labels.h). Fills what is counted in voxels: volume_mask_ml, volume_partial_ml, touches_border,
/// overlap_voxels; of single objects also volume_openvdb_ml and volume_mesh_ml.
/// \pre measure() has run.
VoxelMaps label_map(std::vector<ObjectResult>& objects, const ImageGrid& grid, const SegmentOptions& options);

/// Signed distance to the nearest of all surfaces, mm, negative inside.
Image<float> distance_map(const std::vector<ObjectResult>& objects, const ImageGrid& grid,
                          const SegmentOptions& options);

}  // namespace pellicle
