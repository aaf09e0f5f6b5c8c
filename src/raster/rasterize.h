#pragma once
/// From a closed mesh to voxels and back. Nothing here depends on the number of threads; memory is the result and what
/// the facets near a slice need.

#include <cstdint>

#include "pellicle/image/image.h"
#include "pellicle/mesh/triangle_mesh.h"

namespace pellicle {

/// Marks the voxels of `grid` whose centres lie inside `surface` (vertices in LPS mm): those about which the surface
/// winds at least once, exact to the rounding of the coordinates. Cavities (shells wound inward) stay hollow, overlaps
/// are their union, and of a surface that leaves the grid the part inside it is right. A centre exactly on the surface
/// belongs to the solid that lies on the side of larger x, else y, else z in index space, so that solids side by side
/// share no voxel. Oblique, anisotropic and left-handed grids are honoured: all is done in index space.
/// \pre `surface` is closed and outward-oriented.
/// \throws BadData naming the first edge that is open, the first missing vertex or coordinate that is not finite.
Image<std::uint8_t> rasterize_mask(const TriangleMesh& surface, const ImageGrid& grid);

/// Signed distance in mm at every voxel centre, negative inside (the sign of rasterize_mask). Exact (nearest point of the
/// mesh, in world mm) within `band_mm` of the surface; beyond, clamped to +-band_mm. \throws BadData as above, UsageError
/// unless band_mm is positive.
Image<float> rasterize_signed_distance(const TriangleMesh& surface, const ImageGrid& grid, double band_mm);

/// Fraction of each voxel that is inside, 0..1: facets are cut at the voxel faces and summed by the divergence theorem,
/// so it is exact for the mesh, and its sum times the voxel volume is the mesh's volume to single precision. \throws
/// BadData as above.
Image<float> rasterize_partial_volume(const TriangleMesh& surface, const ImageGrid& grid);

/// Surface between the voxel centres inside (other than 0) and outside: closed, manifold, outward, in LPS mm; empty for an
/// empty mask; masks that touch the border are closed half a voxel beyond it. Rasterising it gives the mask back. Voxels
/// hold together by faces, the outside by faces and edges. Where on the way from centre to centre it passes is taken from
/// the mask under a kernel 5 voxels wide that moves no flat or spherical surface, within that gap always: about 0.08
/// voxels from the surface of a ball of radius 10 or more that was rasterised. (Marching cubes, Lorensen and Cline 1987.)
TriangleMesh surface_of_mask(const Image<std::uint8_t>& mask);

}  // namespace pellicle
