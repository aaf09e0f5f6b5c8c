#pragma once
/// One solid without holes through it around points or out of a mask: where a surface of genus 0 may start.

#include <cstdint>
#include <vector>

#include "pellicle/image/image.h"
#include "pellicle/mesh/triangle_mesh.h"

namespace pellicle {

struct ClosedSolid {
  TriangleMesh surface;     ///< closed, manifold, outward, of genus 0, LPS mm
  double closing_mm = 0.0;  ///< gaps up to about this wide were bridged
  int genus_as_given = 0;   ///< of the solid before it was closed further
};

/// Voxels that hold points are marked on finer and coarser grids, grown, filled and shrunk again; the finest solid that
/// has genus 0 and holds water (at least 0.6 of the volume of the most solid one) is taken.
/// \param spacing typical distance between neighbours, mm: no grid is finer. \throws BadData when nothing encloses a
/// volume (fewer than four points, all in one plane).
ClosedSolid solid_of_points(const std::vector<Vec3>& points, double spacing);

/// The largest part of a mask, cavities filled, closed with growing cubes until it has genus 0.
/// \throws BadData when the mask is empty.
ClosedSolid solid_of_mask(const Image<std::uint8_t>& mask);

}  // namespace pellicle
