#pragma once
/// Small files for a viewer in a page: a cut-out of the volume and the surfaces of all objects.

#include <string>
#include <vector>

#include "pellicle/image/image.h"
#include "pellicle/mesh/triangle_mesh.h"
#include "pellicle/picture/canvas.h"
#include "pellicle/surface/surface.h"

namespace pellicle {

/// The part of `image` around the meshes (a quarter of their extent on each side, at least 6 voxels), black to white as
/// 0..255. Blocks of voxels are averaged until at most edge^3 are left, so that spacings become as alike as they can.
/// \param meshes vertices in LPS mm; none: the whole image. \pre edge >= 8.
Image<std::uint8_t> cut_out(const Image<float>& image, const std::vector<TriangleMesh>& meshes, int edge);

/// All objects as one mesh in NiiVue's MZ3 format (RAS mm, float32, a colour a vertex); not compressed.
std::string mz3_of(const std::vector<TriangleMesh>& meshes, const std::vector<Rgb>& colors);

/// Tessellations for looking at: as fine as `viewing_level`, coarser when all together exceed `most_triangles`.
std::vector<TriangleMesh> viewing_meshes(const std::vector<Surface>& surfaces, std::size_t most_triangles);

/// Distinct also for colour-blind eyes (Okabe and Ito 2008); they come round again after seven.
Rgb object_color(std::size_t index);

}  // namespace pellicle
