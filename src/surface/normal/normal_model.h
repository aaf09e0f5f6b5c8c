#pragma once
/// Normal-based interpolating subdivision surfaces: a triangle control mesh, a point and a unit normal per vertex.
/// Source: Romani, Badoual, Unser (edge rule after Aihua, Jie, Jun, Guiqing 2016), corrected as in docs/models.md: the
/// `smooth` rule has continuous normals, the `published` rule is kept beside it.

#include <array>
#include <string>
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
  NormalModel(int vertex_count, std::vector<std::array<int, 3>> triangles, SubdivisionRule rule, Parameters reference);
  /// A Platonic solid inscribed in the unit sphere.
  static NormalModel start(StartSolid solid, SubdivisionRule rule);

  int vertex_count() const { return vertex_count_; }
  const std::vector<std::array<int, 3>>& triangles() const { return triangles_; }
  SubdivisionRule rule() const { return rule_; }
  /// Parameters of the shape that smoothness and spacing are measured against: the exact unit sphere about the origin
  /// for the start solids; empty when none is known.
  const Parameters& reference() const { return reference_; }

  /// Block 2v is the point of vertex v, block 2v+1 its unit normal.
  std::vector<BlockKind> blocks() const;
  int parameter_count() const { return 6 * vertex_count_; }
  int degrees_of_freedom() const { return 5 * vertex_count_; }
  TriangleMesh control_mesh(const Parameters& parameters) const;
  std::string name() const { return "normal"; }
  int base_facets() const { return static_cast<int>(triangles_.size()); }
  bool is_closed() const { return true; }
  /// How often a start solid was split 1 -> 4 to have about so many triangles.
  int refinements() const;

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

  /// Points and normals of the control mesh from the nearest samples of `layout` on the reference shape: vertices lie
  /// on the surface. A normal stays where the targets have no area.
  /// \pre the model and the layout have a reference shape; targets are one per sample.
  void place_on(const SampleLayout& layout, const SampleTargets& targets, Parameters& parameters) const;
  /// See bending_scale in surface.h.
  static constexpr double kBendingScale = 0.002;

 private:
  int vertex_count_;
  std::vector<std::array<int, 3>> triangles_;
  SubdivisionRule rule_;
  Parameters reference_;
};

}  // namespace pellicle
