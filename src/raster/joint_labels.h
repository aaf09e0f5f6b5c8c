#pragma once
/// Label maps of several closed surfaces: every voxel belongs to one of them.

#include <cstddef>
#include <vector>

#include "pellicle/image/image.h"
#include "pellicle/mesh/triangle_mesh.h"

namespace pellicle {

/// The part of a grid that a surface may touch, and its mask there (rasterize_mask).
struct MaskPiece {
  Index3 first{0, 0, 0};     ///< of the piece in the grid
  Image<std::uint8_t> mask;  ///< empty where the surface lies outside the grid
  std::size_t count = 0;     ///< voxels inside
};
MaskPiece rasterize_piece(const TriangleMesh& surface, const ImageGrid& grid);

/// Number of voxels inside of both.
/// \pre pieces of one grid.
std::size_t shared_voxels(const MaskPiece& a, const MaskPiece& b);

struct JointLabels {
  Image<std::uint16_t> labels;
  std::vector<std::size_t> voxels;  ///< of each surface in the map
  std::vector<std::size_t> shared;  ///< voxels of each that others claim too
};

/// A voxel inside several surfaces goes to the one in which it is deepest for its size: least d / rbar, d the signed
/// distance, rbar the radius of the ball of equal volume; among equals the first. Memory is the map and one mask per
/// surface.
/// \param labels one per surface, other than 0.
/// \throws BadData for open surfaces.
JointLabels label_together(const std::vector<const TriangleMesh*>& surfaces, const std::vector<std::uint16_t>& labels,
                           const ImageGrid& grid);

}  // namespace pellicle
