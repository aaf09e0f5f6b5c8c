#pragma once
/// Sample points of a surface: all that an energy sees of it.

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "pellicle/base/geometry.h"
#include "pellicle/mesh/triangle_mesh.h"

namespace pellicle {

/// Samples owned by one patch and the parameter blocks that they depend on. A sample on a border between patches is
/// owned by exactly one of them, so that each sample is evaluated and counted once.
struct SamplePatch {
  std::vector<int> blocks;
  int first_sample = 0, sample_count = 0;
  std::size_t jacobian_offset = 0;  ///< into SurfaceSamples::jacobian
  int columns() const { return 3 * static_cast<int>(blocks.size()); }
};

struct TriangleRefinement;
struct LinearStencils;

/// Which samples a model has at one density, how they depend on the parameters and how they hang together. Constant as
/// long as the model's control mesh is.
struct SampleLayout {
  int level = 0;                              ///< density: 2^level intervals along a control edge
  std::vector<SamplePatch> patches;           ///< samples are ordered by patch
  std::vector<int> patch_of;                  ///< owner of each sample
  std::vector<std::array<int, 3>> triangles;  ///< closed, outward mesh over the samples
  /// Where each sample lies on the model's reference shape (unit sphere, torus, voxel seed ..., any scale); empty when
  /// the model has none. Smoothness and spacing are measured against it.
  std::vector<Vec3> reference;
  std::vector<int> owned_local;                          ///< model's own: local number of each sample within its patch
  std::shared_ptr<const TriangleRefinement> refinement;  ///< normal model's own: how one patch is refined
  std::shared_ptr<const LinearStencils> stencils;        ///< of the models that are linear in their control points
  int sample_count() const { return static_cast<int>(patch_of.size()); }
};

/// Values at one set of parameters.
struct SurfaceSamples {
  std::vector<Vec3> x;       ///< LPS mm
  std::vector<Vec3> normal;  ///< outward unit normals of the limit surface
  /// dx/d(block parameters), row-major 3 x columns() per sample, samples of a patch one after another from
  /// jacobian_offset. Ambient derivative: unit normals are treated as free 3-vectors. Empty unless asked for.
  std::vector<double> jacobian;
};

/// Where each sample of a layout is wanted.
struct SampleTargets {
  std::vector<Vec3> x;     ///< LPS mm, one per sample
  std::vector<Vec3> area;  ///< outward area vectors of the mesh over x, one per sample; zero where it has none
};

/// The samples as a mesh with normals.
TriangleMesh mesh_of(const SampleLayout& layout, const SurfaceSamples& samples);

/// For each sample of a coarser layout of the same model, the sample of `layout` at its place on the reference shape.
/// \return empty when the two do not have their samples in common, or there is no reference shape.
std::vector<int> samples_of_coarser(const SampleLayout& layout, const SampleLayout& coarser);

}  // namespace pellicle
