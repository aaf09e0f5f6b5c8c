#pragma once
/// A dense, well-shaped mesh of an exact implicit surface, for shapes of any genus.

#include "pellicle/mesh/triangle_mesh.h"
#include "pellicle/synthetic/shapes.h"

namespace pellicle {

/// Dual cells of a regular lattice (surface nets: Gibson 1998), evened out along the surface and projected onto it
/// by Newton steps. Vertices lie on the exact surface up to rounding, normals are the exact ones; closed, manifold
/// and outward.
/// \param cell lattice step, mm: about 3 * area / cell^2 triangles.
/// \pre cell is well below the smallest
/// feature of the shape.
TriangleMesh mesh_of(const Body& body, double cell);

}  // namespace pellicle
