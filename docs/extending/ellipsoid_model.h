#pragma once
/// The ellipsoid as a surface model: x = c + A p over the unit sphere, twelve unknowns (the centre and the columns of
/// A) and nothing to refine. Exact for every ellipsoid. Linear in its unknowns, so the samples are constant
/// combinations of the four blocks, and the shared code of such models does the rest.

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pellicle/mesh/triangle_mesh.h"
#include "pellicle/surface/icosphere.h"
#include "pellicle/surface/linear_stencils.h"

namespace pellicle {

class EllipsoidModel {
 public:
  /// Block 0 is the centre, a point; blocks 1 to 3 are the columns of A, which move with it.
  std::vector<BlockKind> blocks() const {
    return {BlockKind::point, BlockKind::vector, BlockKind::vector, BlockKind::vector};
  }
  /// The reference shape is the unit sphere: c = 0, A = 1.
  Parameters reference() const { return {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}; }
  int degrees_of_freedom() const { return 12; }
  int base_facets() const { return 20; }
  int refinements() const { return 0; }
  bool is_closed() const { return true; }
  std::string name() const { return "ellipsoid"; }

  /// One patch of 10 * 4^level + 2 samples, which all depend on all blocks.
  SampleLayout layout(int level) const {
    const Icosphere sphere = icosphere(level);
    SampleLayout layout;
    LinearStencils stencils;
    begin_patch(layout, {0, 1, 2, 3});
    for (const Vec3& p : sphere.directions) {
      const Vec3 u = p.unitOrthogonal(), v = p.cross(u);  // u x v = p, outward
      add_sample(layout, stencils, {1, p[0], p[1], p[2]}, {0, u[0], u[1], u[2]}, {0, v[0], v[1], v[2]});
    }
    layout.level = level;
    layout.triangles = sphere.triangles;
    layout.reference = sphere.directions;
    layout.stencils = std::make_shared<const LinearStencils>(std::move(stencils));
    return layout;
  }

  /// Normals point outward where det A > 0.
  void evaluate(const Parameters& parameters, const SampleLayout& layout, bool with_jacobian,
                SurfaceSamples& samples) const {
    evaluate_linear(parameters, layout, with_jacobian, samples);
  }
  void pull_back(const Parameters& /*parameters*/, const SampleLayout& layout, const std::vector<Vec3>& dE_dx,
                 std::vector<double>& gradient) const {
    pull_back_linear(layout, dE_dx, gradient);
  }

  std::pair<EllipsoidModel, Parameters> refine(const Parameters& parameters) const { return {*this, parameters}; }
  /// The octahedron of the ends of the axes.
  TriangleMesh control_mesh(const Parameters& parameters) const {
    const auto block = [&](std::size_t b) { return Vec3(parameters.data() + 3 * b); };
    TriangleMesh mesh;
    for (std::size_t b = 1; b < 4; ++b) {
      mesh.vertices.emplace_back(block(0) + block(b));
      mesh.vertices.emplace_back(block(0) - block(b));
    }
    mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    return mesh;
  }
};

}  // namespace pellicle
