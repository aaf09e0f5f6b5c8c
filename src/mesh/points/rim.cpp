#include "pellicle/mesh/points/rim.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "pellicle/base/parallel.h"

namespace pellicle {

namespace {

// Widest angle about the normal in which no neighbour lies.
double widest_gap(const PointTree& tree, const std::vector<PointTree::Neighbour>& ring, const Vec3& at,
                  const Vec3& normal) {
  const Vec3 t1 = normal.unitOrthogonal(), t2 = normal.cross(t1);
  std::vector<double> angles;
  angles.reserve(ring.size());
  for (const auto& neighbour : ring) {
    const Vec3 d = tree.points()[static_cast<std::size_t>(neighbour.point)] - at;
    if (neighbour.distance > 0.0) angles.push_back(std::atan2(d.dot(t2), d.dot(t1)));
  }
  if (angles.empty()) return 2.0 * std::numbers::pi;
  std::sort(angles.begin(), angles.end());
  double widest = angles.front() + 2.0 * std::numbers::pi - angles.back();
  for (std::size_t k = 1; k < angles.size(); ++k) widest = std::max(widest, angles[k] - angles[k - 1]);
  return widest;
}

}  // namespace

FittedPlane plane_through(const std::vector<Vec3>& points) {
  const auto count = static_cast<double>(points.size());
  FittedPlane plane;
  for (const Vec3& x : points) plane.mean += x;
  plane.mean /= count;
  Mat3 spread = Mat3::Zero();
  for (const Vec3& x : points) spread += (x - plane.mean) * (x - plane.mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Mat3> axes(spread);
  plane.normal = axes.eigenvectors().col(0);
  plane.deviation = std::sqrt(std::max(0.0, axes.eigenvalues()[0]) / count);
  return plane;
}

std::vector<Vec3> plane_normals(const PointTree& tree) {
  constexpr int kNeighbours = 12;
  const std::vector<Vec3>& points = tree.points();
  std::vector<Vec3> normals(points.size());
  parallel_for(points.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto ring = tree.nearest(points[i], kNeighbours + 1);
      std::vector<Vec3> near;
      near.reserve(ring.size());
      for (const auto& n : ring) near.push_back(points[static_cast<std::size_t>(n.point)]);
      normals[i] = plane_through(near).normal;
    }
  });
  return normals;
}

RimPoints rim_of(const PointTree& tree, const std::vector<Vec3>& normals) {
  constexpr int kNeighbours = 24;
  constexpr double kGap = 0.65 * std::numbers::pi, kClearGap = 0.75 * std::numbers::pi;
  constexpr int kBeside = 5, kClearBeside = 2;  // itself among them
  const std::vector<Vec3>& points = tree.points();
  std::vector<double> gap(points.size());
  parallel_for(points.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      gap[i] = widest_gap(tree, tree.nearest(points[i], kNeighbours + 1), points[i], normals[i]);
    }
  });
  // Along a straight rim, half a disc of 24 neighbours has about five of them; points inside have one by chance.
  RimPoints rim;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (gap[i] <= kGap) continue;
    const auto ring = tree.nearest(points[i], kNeighbours + 1);
    const auto beside = [&](double least) {
      return std::count_if(ring.begin(), ring.end(), [&](const PointTree::Neighbour& n) {
        return gap[static_cast<std::size_t>(n.point)] > least;
      });
    };
    if (beside(kGap) < kBeside || beside(kClearGap) < kClearBeside) continue;
    Vec3 mean = Vec3::Zero();
    for (const auto& n : ring) mean += points[static_cast<std::size_t>(n.point)] / static_cast<double>(ring.size());
    const Vec3 away = points[i] - mean;
    rim.x.push_back(points[i]);
    rim.outward.push_back((away - away.dot(normals[i]) * normals[i]).normalized());
  }
  return rim;
}

}  // namespace pellicle
