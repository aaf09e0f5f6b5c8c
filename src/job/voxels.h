#pragma once
/// Objects on a voxel grid: work is done in the box of the object, then put into the whole.

#include "pellicle/image/image.h"
#include "pellicle/mesh/triangle_mesh.h"
#include "pellicle/raster/voxel_box.h"
#include "pellicle/surface/surface.h"

namespace pellicle {

using Box = VoxelBox;

/// Signed distance in mm over the whole grid, negative inside. Exact for `mesh` within ten voxels of it; beyond, from a
/// mesh of some thousand facets of the same surface, within one percent: exact queries far away cost a hundred times
/// more.
Image<float> signed_distance(const Surface& surface, const TriangleMesh& mesh, const ImageGrid& grid);

}  // namespace pellicle
