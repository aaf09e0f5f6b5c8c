#pragma once
/// One solid without holes through it around points or out of a mask: where a surface of genus 0 may start.

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

/// Voxels that hold points are marked on finer and coarser grids, grown, filled and shrunk again. Going from the widest
/// to the narrowest gap that this bridges, a solid that loses more than 0.3 of the volume of the one before lets water
/// in and is left out. The narrowest of the rest, or the solid of Gauss's formula (gauss_field.h, from 2000 points at
/// most) where that and the points are nearer to each other, is the solid as given; the narrowest of genus 0 is the
/// surface.
/// \param spacing typical distance between neighbours, mm: no grid is finer.
/// \throws BadData when nothing
/// encloses a volume (fewer than four points, all in one plane).
ClosedSolid solid_of_points(const std::vector<Vec3>& points, double spacing);

/// Turns normals so that they leave the solid: what lies one to three voxels before and behind a point decides. Those
/// of points that have the same on both sides (where sheets melt together) become zero.
void orient_outward(const Image<std::uint8_t>& solid, const std::vector<Vec3>& points, std::vector<Vec3>& normals);

/// The largest part of a mask, cavities filled, closed with growing cubes until it has genus 0.
/// \throws BadData when the mask is empty.
ClosedSolid solid_of_mask(const Image<std::uint8_t>& mask);

}  // namespace pellicle
