#include "pellicle/synthetic/inner_ball.h"

#include <algorithm>
#include <cmath>

namespace pellicle {
namespace {

/// Distance to the nearest vertex: above the true depth by at most edge^2 / (8 depth). 0 outside.
double depth_at(const Body& body, const TriangleMesh& surface, const Vec3& x) {
  if (body.level_at(x).value >= 0.0) return 0.0;
  double nearest = 1e300;
  for (const Vec3& v : surface.vertices) nearest = std::min(nearest, (v - x).squaredNorm());
  return std::sqrt(nearest);
}

/// Centroid of the solid: facets joined to the origin of the mesh make signed tetrahedra.
Vec3 centroid_of_solid(const TriangleMesh& surface) {
  const Vec3 base = surface.vertices.front();
  double volume = 0.0;
  Vec3 moment = Vec3::Zero();
  for (const auto& t : surface.triangles) {
    const Vec3 a = surface.vertices[static_cast<std::size_t>(t[0])] - base;
    const Vec3 b = surface.vertices[static_cast<std::size_t>(t[1])] - base;
    const Vec3 c = surface.vertices[static_cast<std::size_t>(t[2])] - base;
    const double v = a.dot(b.cross(c)) / 6.0;
    volume += v;
    moment += v / 4.0 * (a + b + c);
  }
  return base + moment / volume;
}

/// Pattern search: the six neighbours at a step that halves when none is deeper.
Vec3 deepest_near(const Body& body, const TriangleMesh& surface, Vec3 x, double step) {
  double depth = depth_at(body, surface, x);
  for (const double last = 1e-3 * step; step > last;) {
    Vec3 best = x;
    for (int direction = 0; direction < 6; ++direction) {
      const Vec3 y = x + (direction % 2 == 0 ? step : -step) * Vec3::Unit(direction / 2);
      const double candidate = depth_at(body, surface, y);
      if (candidate > depth) {
        depth = candidate;
        best = y;
      }
    }
    if (best == x) {
      step *= 0.5;
    } else {
      x = best;
    }
  }
  return x;
}

}  // namespace

double mesh_cell(const Shape& shape) {
  // A sphere of radius R: R / 29, 32,000 triangles. Flat shapes need cells below their thickness as well.
  return std::min(std::cbrt(exact_volume(shape)) / 47.0, half_bounds(shape).minCoeff() / 14.0);
}

InnerBall inner_ball(const Body& body, const TriangleMesh& surface) {
  const Vec3 centroid = centroid_of_solid(surface), half = half_bounds(body.shape);
  constexpr int kSteps = 4;
  const double step = half.minCoeff() / kSteps;
  // Starts: a coarse lattice in the shape's frame. The centroid comes first and wins ties of symmetric shapes.
  Vec3 start = centroid;
  double deepest = depth_at(body, surface, centroid) * (1.0 + 1e-3);
  for (int k = -kSteps; k <= kSteps; ++k) {
    for (int j = -kSteps; j <= kSteps; ++j) {
      for (int i = -kSteps; i <= kSteps; ++i) {
        const Vec3 x = body.center + body.world_from_shape * (Vec3(i, j, k) / (kSteps + 1.0)).cwiseProduct(half);
        const double depth = depth_at(body, surface, x);
        if (depth > deepest) {
          deepest = depth;
          start = x;
        }
      }
    }
  }
  InnerBall ball;
  ball.center = deepest_near(body, surface, start, step);
  ball.radius = depth_at(body, surface, ball.center);
  ball.natural_center = depth_at(body, surface, centroid) >= 0.5 * ball.radius ? centroid : ball.center;
  return ball;
}

}  // namespace pellicle
