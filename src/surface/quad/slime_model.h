#pragma once
/// "Slime": tangent-plane continuous generalised biquadratic B-splines of any genus over a closed quad control mesh, a
/// point per vertex. Linear in the points; one patch per vertex, which depends on its neighbours alone.
/// Source: Stoddart, Hilton, Illingworth 1994; see slime_basis.h and docs/any-topology.md.

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pellicle/mesh/quad/point_rows.h"
#include "pellicle/surface/quad/quad_layout.h"
#include "pellicle/surface/quad/slime_basis.h"

namespace pellicle {

class SlimeModel {
 public:
  /// \param quads closed, oriented, manifold control mesh, counter-clockwise from outside, valences 3 to 12.
  /// \throws BadData naming the fault.
  SlimeModel(int vertex_count, const std::vector<Quad>& quads, QuadReference reference);
  /// The cube, refined so many times (8, 26, 98 points ...); its reference is the unit sphere, which the surface meets
  /// to 5.5, 0.30, 0.05 % of the radius at worst.
  static SlimeModel start(int refinements = 0);

  int vertex_count() const { return control_->topology.vertex_count(); }
  const QuadTopology& topology() const { return control_->topology; }
  const QuadReference& reference_shape() const { return control_->reference; }
  const Parameters& reference() const { return control_->reference.points; }

  /// Block v is the point of vertex v.
  std::vector<BlockKind> blocks() const;
  int degrees_of_freedom() const { return 3 * vertex_count(); }
  int base_facets() const { return 2 * static_cast<int>(control_->topology.quads.size()); }
  int refinements() const { return refinements_of(control_->topology); }
  TriangleMesh control_mesh(const Parameters& parameters) const;
  std::string name() const { return "slime"; }
  bool is_closed() const { return true; }

  /// One patch per control vertex. Samples lie on the grid of the control quads, as for Catmull-Clark: level 0 has the
  /// middles of the patches, from level 1 on their borders are sampled, too.
  SampleLayout layout(int level) const;
  void evaluate(const Parameters& parameters, const SampleLayout& layout, bool with_jacobian,
                SurfaceSamples& samples) const;
  void pull_back(const Parameters& parameters, const SampleLayout& layout, const std::vector<Vec3>& dE_dx,
                 std::vector<double>& gradient) const;
  /// The surface at the middle of each patch.
  PointRows limit_rows() const;

  /// Four times as many quads, control points by least squares to the present surface. Not exact (its patches are not
  /// those of the finer mesh): a random surface of radius 1 with 24 points moved by 0.75 % in the mean (3 % at worst)
  /// the first time, 0.14 % and 0.03 % the next. Fit again after.
  std::pair<SlimeModel, Parameters> refine(const Parameters& parameters) const;

  /// Patches of the valences that occur.
  const std::map<int, SlimeBasis>& bases() const { return *bases_; }

 private:
  struct NumberedLayout;
  NumberedLayout numbered_layout(int level) const;

  std::shared_ptr<const QuadControl> control_;
  std::shared_ptr<const std::map<int, SlimeBasis>> bases_;
};

/// Thin plate, the smoothness of Stoddart et al.; fits use the bending energy of energies/bending.h, which works for
/// every model. For programs that compare the two, and for tests. Factor rows: sum_r |sum_k w_rk c_k|^2 = sum over the
/// patches of int |S_uu|^2 + 2 |S_uv|^2 + |S_vv|^2 over regular polygons of unit edges, mm^2.
PointRows thin_plate_rows(const SlimeModel& model);

/// One row per vertex: the point less the mean of its neighbours (Stoddart et al., Section 4: their pull towards the
/// mean and the reaction on the neighbours together are the gradient of half the rows' squares).
PointRows umbrella_rows(const QuadTopology& topology);

}  // namespace pellicle
