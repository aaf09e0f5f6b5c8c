#pragma once
/// Normal-based interpolating subdivision surfaces: a triangle control mesh, a point and a unit normal a vertex.
/// Source: Romani, Badoual, Unser (edge rule after Aihua, Jie, Jun, Guiqing 2016), corrected as in docs/models.md: the
/// `smooth` rule has continuous normals, the `published` rule is kept beside it.

#include <array>
#include <utility>
#include <vector>

#include "pellicle/surface/parameters.h"
#include "pellicle/surface/samples.h"

namespace pellicle {

enum class SubdivisionRule {
  smooth,     ///< convex weights, direction rule on edges inside a control triangle (default)
  published,  ///< as printed; not normal-continuous
  balanced,   ///< w0 = 1/2, perpendicular rule; nests exactly under refine()
};
enum class StartSolid { tetrahedron, octahedron, icosahedron };

class NormalModel {
 public:
  /// \param triangles closed, manifold, oriented control mesh over vertices 0..vertex_count-1, outward.
  /// \throws BadData naming the fault otherwise.
  NormalModel(int vertex_count, std::vector<std::array<int, 3>> triangles, SubdivisionRule rule,
              Parameters on_unit_sphere);
  /// A Platonic solid inscribed in the unit sphere.
  static NormalModel start(StartSolid solid, SubdivisionRule rule);

  int vertex_count() const { return vertex_count_; }
  const std::vector<std::array<int, 3>>& triangles() const { return triangles_; }
  SubdivisionRule rule() const { return rule_; }
  /// Parameters with which the model is the exact unit sphere about the origin (empty for genus > 0).
  const Parameters& on_unit_sphere() const { return on_unit_sphere_; }

  /// Block 2v is the point of vertex v, block 2v+1 its unit normal.
  std::vector<BlockKind> blocks() const;
  int parameter_count() const { return 6 * vertex_count_; }
  int degrees_of_freedom() const { return 5 * vertex_count_; }

  SampleLayout layout(int level) const;
  /// Positions, limit normals and, when asked, Jacobians of all samples. Threads over patches, deterministic.
  void evaluate(const Parameters& parameters, const SampleLayout& layout, bool with_jacobian,
                SurfaceSamples& samples) const;
  /// Adjoint: adds sum_i (dx_i/dparameters)^T dE_dx_i to `gradient` (ambient, parameter_count() entries), about three
  /// times the cost of the values.
  void pull_back(const Parameters& parameters, const SampleLayout& layout, const std::vector<Vec3>& dE_dx,
                 std::vector<double>& gradient) const;

  /// Control mesh split 1 -> 4, new points and normals on the present surface. Identical limit surface for `balanced`
  /// (and `published`); for `smooth` the limit moves slightly unless it is a sphere (docs/models.md): fit again after.
  std::pair<NormalModel, Parameters> refine(const Parameters& parameters) const;

 private:
  int vertex_count_;
  std::vector<std::array<int, 3>> triangles_;
  SubdivisionRule rule_;
  Parameters on_unit_sphere_;
};

/// The image of the model's unit sphere under x -> centre + A x: points centre + A v, normals unit(A^-T v).
Parameters affine_sphere(const NormalModel& model, const Vec3& centre, const Mat3& A);

}  // namespace pellicle
