#include "pellicle/seed/seed_surface.h"

#include "pellicle/mesh/measure.h"
#include "pellicle/mesh/quad/quad_subdivision.h"

namespace pellicle {
namespace {

constexpr int kSweeps = 6;
/// Sweeps for the reference shape: with steps of voxels in it, the bending energy would keep these steps.
constexpr int kReferenceSweeps = 12;

Parameters control_points(const PointRows& limit, const QuadMesh& mesh, int sweeps) {
  return parameters_of(compensated(limit, smoothed_vertices(mesh, sweeps)));
}

/// Unit, of the facets' area vectors.
std::vector<Vec3> vertex_normals(const TriangleMesh& mesh) {
  std::vector<Vec3> normal(mesh.vertices.size(), Vec3::Zero());
  for (const auto& t : mesh.triangles) {
    const auto at = [&](std::size_t c) -> const Vec3& { return mesh.vertices[static_cast<std::size_t>(t[c])]; };
    const Vec3 area = (at(1) - at(0)).cross(at(2) - at(0));
    for (const int v : t) normal[static_cast<std::size_t>(v)] += area;
  }
  for (Vec3& n : normal) n.normalize();
  return normal;
}

template <class Model>
std::pair<Model, Parameters> seed_of(const QuadMesh& mesh) {
  const int count = static_cast<int>(mesh.vertices.size());
  const PointRows limit = Model(count, mesh.quads, {}).limit_rows();
  return {Model(count, mesh.quads, {control_points(limit, mesh, kReferenceSweeps), false}),
          control_points(limit, mesh, kSweeps)};
}

/// Points and normals of the Catmull-Clark surface at its control vertices.
struct LimitPoints {
  std::vector<Vec3> x, normal;
};

LimitPoints limit_points(const LimitMasks& masks, const Parameters& control) {
  const std::vector<Vec3> c = points_of(control);
  LimitPoints result{masks.position.apply(c), std::vector<Vec3>(c.size())};
  for (std::size_t v = 0; v < c.size(); ++v) {
    result.normal[v] = masks.tangent_u.apply(v, c).cross(masks.tangent_v.apply(v, c)).normalized();
  }
  return result;
}

Parameters points_and_normals(const LimitPoints& points) {
  Parameters result;
  result.reserve(6 * points.x.size());
  for (std::size_t v = 0; v < points.x.size(); ++v) {
    result.insert(result.end(), points.x[v].begin(), points.x[v].end());
    result.insert(result.end(), points.normal[v].begin(), points.normal[v].end());
  }
  return result;
}

}  // namespace

std::vector<Vec3> smoothed_vertices(const QuadMesh& mesh, int sweeps) {
  const QuadTopology topology = quad_topology(static_cast<int>(mesh.vertices.size()), mesh.quads);
  const PointRows umbrella = umbrella_rows(topology);
  const TriangleMesh facets = split_quads(mesh);
  const double volume = volume_of(facets);
  TriangleMesh now = facets;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    const std::vector<Vec3> off_mean = umbrella.apply(now.vertices);
    for (std::size_t v = 0; v < off_mean.size(); ++v) now.vertices[v] -= 0.5 * off_mean[v];
    const std::vector<Vec3> normal = vertex_normals(now);
    const double offset = (volume - volume_of(now)) / area_of(now);
    for (std::size_t v = 0; v < off_mean.size(); ++v) now.vertices[v] += offset * normal[v];
  }
  return now.vertices;
}

std::vector<Vec3> compensated(const PointRows& limit, const std::vector<Vec3>& target) {
  constexpr int kCompensations = 20;
  std::vector<Vec3> c = target;
  for (int sweep = 0; sweep < kCompensations; ++sweep) {
    const std::vector<Vec3> surface = limit.apply(c);
    for (std::size_t v = 0; v < c.size(); ++v) c[v] += target[v] - surface[v];
  }
  return c;
}

std::pair<CatmullClarkModel, Parameters> catmull_clark_seed(const QuadMesh& mesh) {
  return seed_of<CatmullClarkModel>(mesh);
}

std::pair<SlimeModel, Parameters> slime_seed(const QuadMesh& mesh) {
  return seed_of<SlimeModel>(mesh);
}

std::pair<NormalModel, Parameters> normal_seed(const QuadMesh& mesh, SubdivisionRule rule) {
  const QuadTopology topology = quad_topology(static_cast<int>(mesh.vertices.size()), mesh.quads);
  const LimitMasks masks = catmull_clark_limit(topology);
  const LimitPoints points = limit_points(masks, control_points(masks.position, mesh, kSweeps));
  const LimitPoints reference = limit_points(masks, control_points(masks.position, mesh, kReferenceSweeps));
  const TriangleMesh split = split_quads({points.x, mesh.quads}, points.normal);
  return {NormalModel(static_cast<int>(points.x.size()), split.triangles, rule, points_and_normals(reference)),
          points_and_normals(points)};
}

std::optional<Surface> seed_surface(const QuadMesh& mesh, const ModelChoice& choice) {
  const auto surface = [](auto&& seed) { return Surface{std::move(seed.first), std::move(seed.second)}; };
  switch (choice.kind) {
    case ModelKind::normal:
      return surface(normal_seed(mesh, choice.rule));
    case ModelKind::catmull_clark:
      return surface(catmull_clark_seed(mesh));
    case ModelKind::slime:
      return surface(slime_seed(mesh));
    default:
      return std::nullopt;
  }
}

}  // namespace pellicle
