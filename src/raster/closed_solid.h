#pragma once
/// A solid of genus 0 around scattered points or from a mask: where a surface of genus 0 starts.

#include <cstdint>
#include <vector>

#include "pellicle/image/image.h"
#include "pellicle/mesh/triangle_mesh.h"

namespace pellicle {

struct ClosedSolid {
  TriangleMesh surface;          ///< closed, manifold, outward, of genus 0, LPS mm
  double closing_mm = 0.0;       ///< gaps up to about this wide were bridged
  int genus_as_given = 0;        ///< of the solid before it was closed further
  Image<std::uint8_t> as_given;  ///< that solid
};

/// On several grids the voxels that hold points are dilated, filled and eroded, which bridges gaps up to some width. Of
/// these solids, from the widest to the narrowest gap, one that loses more than 0.3 of the volume of the one before has
/// a leak and is left out. `as_given` is the solid of the narrowest gap, or that of Gauss's formula (gauss_field.h,
/// from 2000 points at most) if it lies nearer to the points; `surface` belongs to the narrowest gap whose solid has
/// genus 0.
/// \param spacing typical distance between neighbours, mm: no grid is finer.
/// \throws BadData when nothing
/// encloses a volume (fewer than four points, all in one plane).
ClosedSolid solid_of_points(const std::vector<Vec3>& points, double spacing);

/// Turns normals so that they point out of the solid, by what lies one to three voxels on both sides of each point.
/// Normals of points with the same on both sides (where two sheets merge in the solid) become zero.
void orient_outward(const Image<std::uint8_t>& solid, const std::vector<Vec3>& points, std::vector<Vec3>& normals);

/// The largest part of a mask, cavities filled, closed by cubes of growing size until it has genus 0.
/// \throws BadData when the mask is empty.
ClosedSolid solid_of_mask(const Image<std::uint8_t>& mask);

}  // namespace pellicle
