#include <algorithm>

#include "pellicle/base/parallel.h"
#include "pellicle/mesh/points/point_tree.h"
#include "pellicle/mesh/sphere/sphere_map.h"

namespace pellicle {

std::vector<double> inner_radii(const TriangleMesh& mesh) {
  const std::size_t n = mesh.vertices.size();
  std::vector<Vec3> normal(n, Vec3::Zero());
  Vec3 lo = mesh.vertices.front(), hi = lo;
  for (const auto& t : mesh.triangles) {
    const Vec3 area = (mesh.vertices[idx(t[1])] - mesh.vertices[idx(t[0])])
                          .cross(mesh.vertices[idx(t[2])] - mesh.vertices[idx(t[0])]);
    for (const int v : t) normal[idx(v)] += area;
  }
  for (const Vec3& v : mesh.vertices) {
    lo = lo.cwiseMin(v);
    hi = hi.cwiseMax(v);
  }
  const double most = 0.5 * (hi - lo).norm();
  const PointTree tree(mesh.vertices);
  std::vector<double> radius(n, most);
  parallel_for(n, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const Vec3& p = mesh.vertices[v];
      const Vec3 inward = -normal[v].normalized();
      if (!inward.allFinite()) continue;
      for (int k = 0; k < 30; ++k) {
        const auto near = tree.nearest(p + radius[v] * inward, 1).front();
        if (near.distance >= radius[v] * (1.0 - 1e-6)) break;
        const Vec3 to = mesh.vertices[idx(near.point)] - p;
        const double height = inward.dot(to);
        if (!(height > 0.0)) break;
        radius[v] = 0.5 * to.squaredNorm() / height;
      }
    }
  });
  for (int round = 0; round < 3; ++round) {
    std::vector<double> total(n, 0.0), count(n, 0.0);
    for (const auto& t : mesh.triangles) {
      for (const int v : t) {
        for (const int w : t) {
          total[idx(v)] += radius[idx(w)];
          count[idx(v)] += 1.0;
        }
      }
    }
    for (std::size_t v = 0; v < n; ++v) radius[v] = count[v] > 0.0 ? total[v] / count[v] : radius[v];
  }
  return radius;
}

}  // namespace pellicle
