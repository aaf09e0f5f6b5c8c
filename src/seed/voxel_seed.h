#pragma once
/// Start meshes of any genus from voxels. Source: Stoddart, Hilton, Illingworth 1994, Section 5, with the repair of
/// places that are not a surface (docs/any-topology.md).

#include <optional>

#include "pellicle/image/image.h"
#include "pellicle/mesh/quad/quad_mesh.h"

namespace pellicle {

/// Kind of the boundary between inside and outside at a grid vertex, from the 8 voxels around it.
struct VoxelBlock {
  enum class Kind { no_surface, manifold, edge_fault, vertex_fault } kind = Kind::no_surface;
  int valence = 0;  ///< faces at the vertex
};
/// \param pattern bit 4 a + 2 b + c stands for the voxel at (a, b, c) of the block, 0 or 1 along i, j, k.
VoxelBlock classify_block(unsigned pattern);

/// The voxels that hold scattered points of a closed surface, dilated (26 neighbours) and eroded (6), so that gaps
/// close; their outer boundary is about one voxel outside of the object. make_manifold fills the inside.
/// \param spacing_mm edge of a voxel, along the axes of the world.
/// \throws BadData without points, UsageError unless the spacing is positive.
Image<std::uint8_t> voxels_of_points(const std::vector<Vec3>& points, double spacing_mm);

/// Thin limbs of a mask: kept only where a voxel is full enough, or followed by single voxels (mask/limb_growth.h).
enum class Limbs { as_voxels_show, followed };
/// Voxels of `spacing_mm` along the mask's axes of which `fraction` or more is inside: half keeps the size, less keeps
/// thin limbs. With Limbs::followed only the largest part is kept, and following does not change its topology; the mask
/// should be one part.
/// \throws BadData for an empty mask, UsageError unless the spacing is positive.
Image<std::uint8_t> voxels_of_mask(const Image<std::uint8_t>& mask, double spacing_mm, double fraction = 0.5,
                                   Limbs limbs = Limbs::as_voxels_show);

/// A third of the smallest edge of the bounding box (world's axes; the mask's own axes): the coarsest grid that makes
/// sense.
/// \throws BadData when empty.
double coarsest_spacing(const std::vector<Vec3>& points);
double coarsest_spacing(const Image<std::uint8_t>& mask);

/// Fills voxels until the boundary is one closed manifold surface: every block about a grid vertex manifold, no cavity,
/// one part. In each critical block the empty voxel with most neighbours (faces) is filled. Voxels are only
/// added and the bounding box stays, so the repair ends. The image is cropped and padded by one voxel.
/// \return how many voxels were added.
/// \throws BadData when no voxel is inside.
std::size_t make_manifold(Image<std::uint8_t>& voxels);

/// The faces between inside and outside as a quad mesh in LPS mm.
/// \pre make_manifold() has run.
/// \throws BadData for an empty image or a boundary that is not a manifold.
QuadMesh boundary_of_voxels(const Image<std::uint8_t>& voxels);

struct VoxelSeed {
  QuadMesh mesh;
  int genus = 0;
  double spacing_mm = 0.0;
  std::size_t filled = 0;  ///< voxels that the repair added
};
/// A start mesh from a mask. Without a spacing several grids are tried, from the coarsest on, each finer by sqrt(2),
/// down to the mask's voxels or a 24th of the smallest edge. The coarsest of the longest run of grids with one genus is
/// taken: handles of the object are there on many grids, those of noise only on the finest.
/// \throws as above.
VoxelSeed voxel_seed_of_mask(const Image<std::uint8_t>& mask, std::optional<double> spacing_mm = {},
                             double fraction = 0.5);
/// A start mesh from the voxels of voxels_of_mask or voxels_of_points.
/// \throws BadData when no voxel is inside.
VoxelSeed voxel_seed_of_voxels(Image<std::uint8_t> voxels);
/// For points of a surface, at the coarsest spacing unless one is given (handles need a finer one).
VoxelSeed voxel_seed_of_points(const std::vector<Vec3>& points, std::optional<double> spacing_mm = {});

}  // namespace pellicle
