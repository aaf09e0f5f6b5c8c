#include <algorithm>
#include <cmath>

#include "pellicle/base/errors.h"
#include "pellicle/base/parallel.h"
#include "pellicle/mesh/distance.h"
#include "pellicle/mesh/measure.h"

namespace pellicle {

std::vector<Vec3> sample_surface(const TriangleMesh& mesh, int count) {
  std::vector<double> until(mesh.triangles.size());  // area up to and with each facet
  double area = 0.0;
  const auto vertex = [&](std::size_t f, std::size_t i) -> const Vec3& {
    return mesh.vertices[static_cast<std::size_t>(mesh.triangles[f][i])];
  };
  for (std::size_t f = 0; f < until.size(); ++f) {
    area += 0.5 * (vertex(f, 1) - vertex(f, 0)).cross(vertex(f, 2) - vertex(f, 0)).norm();
    until[f] = area;
  }
  std::vector<Vec3> points;
  if (!(area > 0.0) || count <= 0) return points;
  points.reserve(static_cast<std::size_t>(count));
  std::size_t f = 0;
  for (int s = 0; s < count; ++s) {
    const double target = (s + 0.5) / count * area;
    while (f + 1 < until.size() && until[f] < target) ++f;
    // The additive recurrence of the plastic number fills a facet evenly however many samples it gets.
    double u = std::fmod(0.5 + s * 0.7548776662466927, 1.0), v = std::fmod(0.5 + s * 0.5698402909980532, 1.0);
    if (u + v > 1.0) {
      u = 1.0 - u;
      v = 1.0 - v;
    }
    points.emplace_back(vertex(f, 0) + u * (vertex(f, 1) - vertex(f, 0)) + v * (vertex(f, 2) - vertex(f, 0)));
  }
  return points;
}

namespace {

std::vector<double> distances_to(const ClosestPoint& target, const std::vector<Vec3>& points) {
  std::vector<double> distance(points.size());
  parallel_for(points.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) distance[i] = target.query(points[i]).distance;
  });
  return distance;
}

struct Directed {
  double area, mean, hd95, hd, within;
};

Directed directed(const TriangleMesh& from, const ClosestPoint& to, double tolerance_mm, int samples) {
  std::vector<double> d = distances_to(to, sample_surface(from, samples));
  if (d.empty()) throw BadData("surface distances (mesh): a surface has no area");
  Directed out{area_of(from), 0.0, 0.0, 0.0, 0.0};
  for (const double x : d) {
    out.mean += x;
    out.within += x <= tolerance_mm ? 1.0 : 0.0;
  }
  const auto n = static_cast<double>(d.size());
  out.mean /= n;
  out.within /= n;
  std::sort(d.begin(), d.end());
  const double rank = 0.95 * (n - 1.0);
  const auto below = static_cast<std::size_t>(rank);
  const std::size_t above = std::min(below + 1, d.size() - 1);
  out.hd95 = d[below] + (rank - static_cast<double>(below)) * (d[above] - d[below]);
  // Samples miss the tips, where the maximum mostly is: the corners are looked at too.
  std::vector<Vec3> corners;
  corners.reserve(from.vertices.size());
  std::vector<bool> used(from.vertices.size());
  for (const auto& t : from.triangles) {
    for (const int i : t) used[static_cast<std::size_t>(i)] = true;
  }
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i]) corners.push_back(from.vertices[i]);
  }
  out.hd = d.back();
  for (const double x : distances_to(to, corners)) out.hd = std::max(out.hd, x);
  return out;
}

}  // namespace

SurfaceDistances surface_distances(const TriangleMesh& a, const TriangleMesh& b, double tolerance_mm, int samples) {
  const ClosestPoint to_a(a), to_b(b);
  const Directed ab = directed(a, to_b, tolerance_mm, samples), ba = directed(b, to_a, tolerance_mm, samples);
  const double area = ab.area + ba.area;
  return {(ab.area * ab.mean + ba.area * ba.mean) / area, std::max(ab.hd95, ba.hd95), std::max(ab.hd, ba.hd),
          (ab.area * ab.within + ba.area * ba.within) / area};
}

}  // namespace pellicle
