#pragma once
/// Shaded view of a surface mesh, as a photograph would show it.

#include <optional>

#include "pellicle/mesh/triangle_mesh.h"
#include "pellicle/picture/canvas.h"

namespace pellicle {

/// View from the front left above: z-buffer, Phong shading with the vertex normals.
/// \param mesh vertices in LPS mm.
/// \param size edge of the picture, pixels.
/// \param extent_mm what 84 % of the picture's edge shows, for views at one scale; default: the mesh's own extent.
Canvas draw_shaded(const TriangleMesh& mesh, int size, std::optional<double> extent_mm = {});

/// Larger edge of the mesh's box in that view, mm.
double shaded_extent(const TriangleMesh& mesh);

}  // namespace pellicle
