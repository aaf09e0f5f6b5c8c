#pragma once
/// From a closed mesh to voxels and back. Nothing here depends on the number of threads; memory is the result and what
/// the facets near a slice need.

#include <cstdint>
#include <optional>

#include "pellicle/image/image.h"
#include "pellicle/mesh/triangle_mesh.h"

namespace pellicle {

/// A mask and its check. A mask's volume is the number of its voxels times the volume of one.
struct MaskResult {
  Image<std::uint8_t> mask;                  ///< 1 inside, 0 outside
  bool from_openvdb = false;                 ///< see rasterize_mask_checked
  std::optional<double> openvdb_volume_mm3;  ///< of OpenVDB's mask before correction; none where it was not asked
  double exact_volume_mm3 = 0.0;             ///< of the mask
  double mesh_volume_mm3 = 0.0;              ///< of the mesh (divergence theorem), what lies outside the grid included
  std::size_t corrected_voxels = 0;          ///< in which OpenVDB's mask and the winding numbers differ
};

/// Marks the voxels of `grid` whose centres lie inside `surface` (vertices in LPS mm): those about which the surface
/// winds at least once, exact to the rounding of the coordinates. OpenVDB's level set on the voxels says what is
/// inside; winding numbers check each voxel, and where the two differ (OpenVDB's signs are sometimes wrong next to
/// facets) they stand. When the volumes of the two differ by more than 0.5 % and by more than a layer of 0.02 voxels
/// (cavities, which OpenVDB fills, walls thinner than a voxel, surfaces turned inside out), or OpenVDB was not asked
/// because most of the surface lies outside the grid, the mask is by winding numbers alone and `from_openvdb` is false.
/// Cavities (shells wound inward) stay hollow, overlaps are their union, and of a surface that leaves the grid the part
/// inside it is right. A centre exactly on the surface belongs to the solid that lies on the side of larger x, else y,
/// else z in index space, so that no voxel belongs to two solids side by side. Oblique, anisotropic and left-handed
/// grids are honoured: all is done in index space.
/// \pre `surface` is closed and outward-oriented.
/// \throws BadData
/// naming the first edge that is open, the first missing vertex or coordinate that is not finite.
MaskResult rasterize_mask_checked(const TriangleMesh& surface, const ImageGrid& grid);
/// The same mask by winding numbers alone, in a tenth of the time: for inner loops.
Image<std::uint8_t> rasterize_mask(const TriangleMesh& surface, const ImageGrid& grid);

/// Signed distance in mm at every voxel centre, negative inside (the sign of rasterize_mask), clamped to +-band_mm.
/// On isotropic grids it is OpenVDB's within one voxel of the surface, where its nodes, the voxel centres, hold the
/// distance to the nearest facet. Everywhere else (OpenVDB's second nearest facet, other grids, masks of OpenVDB that
/// were refused) it is the distance to the nearest point of the mesh by exact search.
/// \throws BadData as above,
/// UsageError unless band_mm is positive.
Image<float> rasterize_signed_distance(const TriangleMesh& surface, const ImageGrid& grid, double band_mm);

/// Fraction of each voxel that is inside, 0..1: facets are cut at the voxel faces and summed by the divergence theorem,
/// so it is exact for the mesh, and its sum times the voxel volume is the mesh's volume to single precision (1e-7).
/// Planes from OpenVDB's distance and gradient add 1/(12 R) voxels to a sphere of radius R by its curvature, 0.25 % of
/// the volume at R = 10; hence not from OpenVDB.
/// \throws BadData as above.
Image<float> rasterize_partial_volume(const TriangleMesh& surface, const ImageGrid& grid);

/// Surface between the voxel centres inside (other than 0) and outside: closed, manifold, outward, in LPS mm; empty for
/// an empty mask; masks that touch the border are closed half a voxel beyond it. Rasterising it gives the mask back.
/// Voxels hold together by faces, the outside by faces and edges. Where on the way from centre to centre it passes is
/// taken from the mask under a kernel 5 voxels wide that moves no flat or spherical surface, within that gap always:
/// about 0.08 voxels from the surface of a ball of radius 10 or more that was rasterised. (Marching cubes, Lorensen and
/// Cline 1987.)
TriangleMesh surface_of_mask(const Image<std::uint8_t>& mask);

}  // namespace pellicle
