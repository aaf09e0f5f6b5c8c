#pragma once
/// The subdivision of one control triangle in dual numbers: the oracle of the hand-written derivatives, and what they
/// are measured against in bench/runtime.

#include <ceres/jet.h>

#include <vector>

#include "pellicle/surface/normal/internal/normal_edge_rule.h"
#include "pellicle/surface/normal/internal/triangle_refinement.h"
#include "pellicle/surface/normal/normal_model.h"

namespace pellicle::oracle {

using Jet18 = ceres::Jet<double, 18>;
using JetVertex = PointNormal<Jet18>;

template <EdgeRule rule>
JetVertex refined(const RefinedVertex& v, const std::vector<JetVertex>& all) {
  Vector3<Jet18> d = Vector3<Jet18>::Zero();
  if (rule == EdgeRule::convex_direction) d = all[v.left].p - all[v.right].p;
  return refine_edge<rule, Jet18>(all[v.a].p, all[v.a].n, all[v.b].p, all[v.b].n, d);
}

/// Every local vertex of a patch; columns as in SurfaceSamples::jacobian.
inline void refine_patch(const TriangleRefinement& refinement, SubdivisionRule rule, const Parameters& parameters,
                         const SamplePatch& patch, std::vector<JetVertex>& all) {
  all.resize(refinement.vertex_count());
  for (int column = 0; column < 18; ++column) {
    JetVertex& corner = all[column / 6];
    Vector3<Jet18>& vector = column / 3 % 2 == 0 ? corner.p : corner.n;
    vector[column % 3] = Jet18(parameters[3 * std::size_t(patch.blocks[column / 3]) + column % 3], column);
  }
  for (int i = 3; i < refinement.vertex_count(); ++i) {
    const RefinedVertex& v = refinement.vertices[i];
    if (rule == SubdivisionRule::published) {
      all[i] = refined<EdgeRule::published>(v, all);
    } else if (rule == SubdivisionRule::balanced) {
      all[i] = refined<EdgeRule::balanced>(v, all);
    } else if (v.left < 0) {
      all[i] = refined<EdgeRule::convex>(v, all);
    } else {
      all[i] = refined<EdgeRule::convex_direction>(v, all);
    }
  }
}

}  // namespace pellicle::oracle
