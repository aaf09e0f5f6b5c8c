#include "pellicle/synthetic/inner_ball.h"

#include <algorithm>
#include <cmath>

#include "pellicle/base/random.h"
#include "pellicle/mesh/measure.h"

namespace pellicle {
namespace {

/// Distance to the nearest vertex: above the true depth by at most edge^2 / (8 depth). 0 outside.
double depth_at(const Body& body, const TriangleMesh& surface, const Vec3& x) {
  if (body.level_at(x).value >= 0.0) return 0.0;
  double nearest = 1e300;
  for (const Vec3& v : surface.vertices) nearest = std::min(nearest, (v - x).squaredNorm());
  return std::sqrt(nearest);
}

/// Random search with a step that halves when no direction goes deeper. Random directions, because the depth has
/// ridges along the medial axis on which a fixed set of directions gets stuck.
Vec3 deepest_near(const Body& body, const TriangleMesh& surface, Vec3 x, double step) {
  constexpr int kDirections = 40;
  RandomEngine random(1);
  double depth = depth_at(body, surface, x);
  for (const double last = 1e-3 * step; step > last;) {
    Vec3 best = x;
    for (int k = 0; k < kDirections; ++k) {
      const Vec3 y = x + step * Vec3(random.normal(), random.normal(), random.normal()).normalized();
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

/// Centre of the largest ball inside that touches the surface at its first vertex.
Vec3 touching_ball(const TriangleMesh& surface) {
  const Vec3 &p = surface.vertices.front(), &normal = surface.normals.front();
  double radius = 1e300;
  for (const Vec3& q : surface.vertices) {
    const double below = normal.dot(p - q);
    if (below > 0.0) radius = std::min(radius, (p - q).squaredNorm() / (2.0 * below));
  }
  return p - radius * normal;
}

}  // namespace

double mesh_cell(const Shape& shape) {
  // A sphere of radius R: R / 29, 32,000 triangles. Flat shapes need cells below their thickness as well.
  return std::min(std::cbrt(exact_volume(shape)) / 47.0, half_bounds(shape).minCoeff() / 14.0);
}

InnerBall inner_ball(const Body& body, const TriangleMesh& surface) {
  const Vec3 centroid = centroid_of(surface), half = half_bounds(body.shape);
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
  // A thin ring slips between the points of the lattice.
  if (deepest <= 0.0) start = touching_ball(surface);
  InnerBall ball;
  ball.center = deepest_near(body, surface, start, step);
  ball.radius = depth_at(body, surface, ball.center);
  ball.natural_center = depth_at(body, surface, centroid) >= 0.5 * ball.radius ? centroid : ball.center;
  return ball;
}

}  // namespace pellicle
