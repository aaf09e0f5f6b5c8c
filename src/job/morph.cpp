#include "pellicle/job/morph.h"

#include <algorithm>
#include <cmath>

#include "pellicle/mesh/distance.h"
#include "pellicle/mesh/measure.h"

namespace pellicle {

namespace {

constexpr int kMostMorphFacets = 120000;

/// One density for all steps, so that their meshes correspond vertex by vertex.
int mesh_level(const MorphOptions& options, const MatchedSurfaces& surfaces) {
  if (options.mesh_level) return *options.mesh_level;
  int level = std::max(viewing_level(surfaces.a), viewing_level(surfaces.b));
  while (level > 2 && (base_facets(surfaces.a.model) << (2 * level)) > kMostMorphFacets) --level;
  return level;
}

MorphStep measured(double tau, Surface surface, int level) {
  MorphStep step{.tau = tau, .surface = std::move(surface)};
  step.mesh = tessellate(step.surface, level);
  const MeshTopology topology = topology_of(step.mesh);
  step.watertight = topology.closed && topology.manifold && topology.oriented;
  step.genus = topology.genus;
  constexpr int dense = 4;  // coarse meshes still get the figures of the smooth surface
  const TriangleMesh fine = level < dense ? tessellate(step.surface, dense) : step.mesh;
  step.area_mm2 = area_of(fine);
  step.self_intersections = self_intersection_count(step.mesh);
  if (step.self_intersections > 0) step.status = FitStatus::folded;
  if (!step.watertight) return step;
  step.volume_ml = volume_with_normals(fine) / 1000.0;
  if (*step.volume_ml < 0.0) {
    step.status = FitStatus::inside_out;
    step.volume_ml = -*step.volume_ml;
    for (auto& triangle : step.mesh.triangles) std::swap(triangle[1], triangle[2]);
    for (auto& normal : step.mesh.normals) normal = -normal;
  }
  return step;
}

/// How far refinement moved a surface, mm.
double moved(const Surface& before, const Surface& after, bool changed) {
  if (!changed) return 0.0;
  const auto mesh = [](const Surface& surface) { return tessellate(surface, viewing_level(surface)); };
  return surface_distances(mesh(before), mesh(after), 1.0).hd;
}

}  // namespace

std::vector<double> taus_of(const MorphOptions& options) {
  if (options.steps == 1) return {0.5 * (options.from + options.to)};
  std::vector<double> taus;
  taus.reserve(static_cast<std::size_t>(options.steps));
  for (int i = 0; i < options.steps; ++i) {
    const double tau = options.from + (options.to - options.from) * i / (options.steps - 1);
    const double end = std::round(tau);  // rounding must not miss A and B, which are exact there only
    taus.push_back(std::abs(tau - end) < 1e-12 ? end : tau);
  }
  return taus;
}

Morphing morph(const Surface& a, const Surface& b, const MorphOptions& options, const Observer& observer) {
  Morphing result;
  PhaseClock clock;
  clock.start("match");
  const MatchedSurfaces matched = match_surfaces(a, b);
  result.points_a = control_point_count(a.model);
  result.points_b = control_point_count(b.model);
  result.points = control_point_count(matched.a.model);
  result.moved_a_mm = moved(a, matched.a, matched.a_changed);
  result.moved_b_mm = moved(b, matched.b, matched.b_changed);
  const MorphPath path = morph_path(matched, options.space);
  result.moments = path.moments;
  clock.start("morph");
  const std::vector<double> taus = taus_of(options);
  const int level = mesh_level(options, matched);
  for (std::size_t i = 0; i < taus.size(); ++i) {
    observer.tell_progress(static_cast<double>(i) / static_cast<double>(taus.size()), "morphing");
    observer.check_stopped();
    result.steps.push_back(measured(taus[i], surface_at(path, taus[i]), level));
  }
  clock.stop();
  result.seconds = clock.seconds();
  return result;
}

}  // namespace pellicle
