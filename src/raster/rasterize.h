#pragma once
/// From a closed mesh to voxels, by OpenVDB.

#include <cstdint>

#include "pellicle/image/image.h"
#include "pellicle/mesh/triangle_mesh.h"

namespace pellicle {

/// Marks the voxels of `grid` whose centres lie inside `surface` (vertices in LPS mm). Oblique, anisotropic and
/// left-handed grids are honoured: the level set is built in index space, where voxel centres are its nodes.
/// \pre `surface` is closed and outward-oriented.  \throws BadData naming the first open edge.
Image<std::uint8_t> rasterize_mask(const TriangleMesh& surface, const ImageGrid& grid);

/// Signed distance in mm at every voxel centre, negative inside. Exact (closest point on the mesh) within `band_mm` of
/// the surface; beyond, clamped to +-band_mm.
Image<float> rasterize_signed_distance(const TriangleMesh& surface, const ImageGrid& grid, double band_mm);

/// Fraction of each voxel that is inside, 0..1; its sum times the voxel volume agrees with the mesh's volume.
Image<float> rasterize_partial_volume(const TriangleMesh& surface, const ImageGrid& grid);

/// Iso-surface of a mask at one half, smoothed by nothing: faces of a level set through voxel centres (surface nets of
/// OpenVDB's volumeToMesh), closed, outward, in LPS mm. Masks that touch the border are closed there.
TriangleMesh surface_of_mask(const Image<std::uint8_t>& mask);

}  // namespace pellicle
