#pragma once
/// Catmull-Clark subdivision surfaces of any topology: a quad control mesh, one point per vertex. Linear in the points.
/// Source: Catmull, Clark 1978; as a deformable model Qin, Mandal, Vemuri 1997, corrected as in docs/any-topology.md.

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pellicle/mesh/quad/point_rows.h"
#include "pellicle/surface/quad/quad_layout.h"

namespace pellicle {

class CatmullClarkModel {
 public:
  /// \param quads oriented manifold control mesh over vertices 0 .. vertex_count - 1, counter-clockwise from outside.
  /// Segmentation needs closed ones.
  /// \throws BadData naming the fault.
  CatmullClarkModel(int vertex_count, const std::vector<Quad>& quads, QuadReference reference,
                    Border border = Border::refused);
  /// The cube, refined so many times (8, 26, 98 points ...); its reference is the unit sphere, which the limit meets to
  /// 2.0, 0.14, 0.02 % of the radius at worst.
  static CatmullClarkModel start(int refinements = 0);

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
  std::string name() const { return "catmull-clark"; }
  bool is_closed() const { return control_->topology.closed(); }

  /// One patch per quad. Positions and normals are those of the limit, to rounding.
  SampleLayout layout(int level) const;
  void evaluate(const Parameters& parameters, const SampleLayout& layout, bool with_jacobian,
                SurfaceSamples& samples) const;
  void pull_back(const Parameters& parameters, const SampleLayout& layout, const std::vector<Vec3>& dE_dx,
                 std::vector<double>& gradient) const;
  /// The limit surface at each control vertex.
  PointRows limit_rows() const;

  /// One Catmull-Clark step: four times as many quads, exactly the same surface.
  std::pair<CatmullClarkModel, Parameters> refine(const Parameters& parameters) const;

 private:
  std::shared_ptr<const QuadControl> control_;
};

/// Thin plate under tension, the smoothness of Qin et al.; fits use the bending energy of energies/bending.h, which
/// works for every model. For programs that compare the two, and for tests.
///
/// Factor rows: sum_r |sum_k w_rk c_k|^2 = sum over the quads of
/// int membrane (|x_s|^2 + |x_t|^2) + bending (|x_ss|^2 + 2 |x_st|^2 + |x_tt|^2) ds dt, in mm^2, by 4 x 4 Gauss points
/// per polynomial piece (exact). Qin et al. 1997, Eq. (20) with the rotation-invariant weights.
///
/// At vertices of valence 5 and more that integral of the limit surface is infinite (each ring of pieces towards the
/// vertex adds 1.2 to 1.5 times the one before), so the limit is replaced by bicubic patches around them after three
/// levels: finite, but the value there belongs to that depth. (The other sound choice, a rigidity that falls by 4 per
/// ring, is not offered.)
PointRows thin_plate_rows(const CatmullClarkModel& model, double membrane, double bending);

}  // namespace pellicle
