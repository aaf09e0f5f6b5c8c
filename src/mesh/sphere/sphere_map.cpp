#include "pellicle/mesh/sphere/sphere_map.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "pellicle/base/errors.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/mesh/sphere/internal/collapse.h"
#include "pellicle/mesh/sphere/internal/stretch.h"

namespace pellicle {

namespace {

/// Weight of the Dirichlet energy of the inverse map. Without it the map has ripples along directions in which the
/// stretch does not change, and smooth models cannot follow.
constexpr double kInverse = 2.0;

/// The constants of one triangle in the energy, while vertices move on the sphere.
struct TriangleCost {
  double area = 0.0;
  double dirichlet = 0.0;             ///< weight over 8 times the plain area
  std::array<double, 3> opposite2{};  ///< squared length of the side opposite to each corner
};

/// Convex polygon in a tangent plane, clipped by half planes.
using Polygon = std::vector<Eigen::Vector2d>;

Polygon clipped(const Polygon& in, double c, const Eigen::Vector2d& g) {
  Polygon out;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const Eigen::Vector2d &p = in[i], &q = in[(i + 1) % in.size()];
    const double sp = c + g.dot(p), sq = c + g.dot(q);
    if (sp >= 0.0) out.push_back(p);
    if ((sp > 0.0 && sq < 0.0) || (sp < 0.0 && sq > 0.0)) out.push_back(p + sp / (sp - sq) * (q - p));
  }
  return out;
}

class Mapper {
 public:
  Mapper(const TriangleMesh& mesh, const SphereMapSettings& settings, const Observer& observer)
      : mesh_(mesh),
        settings_(settings),
        observer_(observer),
        collapsed_(mesh),
        place_(mesh.vertices.size(), Vec3::Zero()),
        importance_(mesh.vertices.size(), 1.0) {
    if (settings.fairness > 0.0) weigh();
  }

  SphereMap run() {
    if (collapsed_.vertex_count() != 4) throw BadData("spherical map (mesh): it cannot be reduced to a tetrahedron");
    start();
    int next = 8;
    const int most = std::min(settings_.max_vertices, collapsed_.all_vertices());
    while (collapsed_.vertex_count() < most) {
      insert(collapsed_.split());
      if (collapsed_.vertex_count() >= next || collapsed_.vertex_count() == most) {
        observer_.check_stopped();
        relax_all(collapsed_.vertex_count() < 500 ? 2 * settings_.sweeps : settings_.sweeps);
        next = std::max(next + 4, collapsed_.vertex_count() * 5 / 4);
      }
    }
    relax_all(3 * settings_.sweeps);
    return result();
  }

 private:
  void start() {
    int first = 0;
    while (!collapsed_.has_triangle(first)) ++first;
    const auto& t = collapsed_.triangle(first);
    int fourth = 0;
    while (!collapsed_.has_vertex(fourth) || std::find(t.begin(), t.end(), fourth) != t.end()) ++fourth;
    // Seen from outside the triangle runs counter-clockwise, with the fourth corner behind it.
    place_[idx(t[0])] = Vec3(1, 1, 1).normalized();
    place_[idx(t[1])] = Vec3(-1, 1, -1).normalized();
    place_[idx(t[2])] = Vec3(1, -1, -1).normalized();
    place_[idx(fourth)] = Vec3(-1, -1, 1).normalized();
    if (place_[idx(t[0])].cross(place_[idx(t[1])]).dot(place_[idx(t[2])]) < 0.0) {
      std::swap(place_[idx(t[1])], place_[idx(t[2])]);
    }
  }

  TriangleCost cost_of(int triangle, double mean_area) const {
    const auto& c = collapsed_.triangle(triangle);
    const Vec3 &a = mesh_.vertices[idx(c[0])], &b = mesh_.vertices[idx(c[1])], &d = mesh_.vertices[idx(c[2])];
    // A small area in addition for every triangle, or slivers would get no place at all.
    constexpr double kLeastArea = 1e-2;  // of the mean
    TriangleCost cost;
    cost.area = 0.5 * (b - a).cross(d - a).norm() + kLeastArea * mean_area;
    cost.opposite2 = {(d - b).squaredNorm() + kLeastArea * mean_area, (a - d).squaredNorm() + kLeastArea * mean_area,
                      (b - a).squaredNorm() + kLeastArea * mean_area};
    const double scale2 = area_ / (4.0 * std::numbers::pi);
    cost.dirichlet = kInverse * scale2 * scale2 / (8.0 * cost.area);
    // E is least when the areas on the sphere go with the root of the weight.
    cost.area *= (importance_[idx(c[0])] + importance_[idx(c[1])] + importance_[idx(c[2])]) / 3.0;
    return cost;
  }

  void weigh() {
    const std::vector<double> radius = inner_radii(mesh_);
    std::vector<double> sorted = radius;
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
    const double median = sorted[sorted.size() / 2];
    constexpr double kMost = 30.0;  // times as much of the sphere: noise must not take all of it
    for (std::size_t v = 0; v < radius.size(); ++v) {
      const double enlarged = std::pow(median / std::max(radius[v], 1e-6 * median), settings_.fairness);
      importance_[v] = std::pow(std::clamp(enlarged, 1.0 / kMost, kMost), 2.0);
    }
  }

  double mean_area() const { return area_ / (2.0 * collapsed_.vertex_count() - 4.0); }

  Star star_of(int v) const {
    Star star;
    star.wedges.reserve(collapsed_.triangles_at(v).size());
    for (const int t : collapsed_.triangles_at(v)) {
      const auto& c = collapsed_.triangle(t);
      const std::size_t i = c[0] == v ? 0 : c[1] == v ? 1 : 2, j = (i + 1) % 3, k = (i + 2) % 3;
      const TriangleCost cost = cost_of(t, mean_area());
      const Vec3 &a = place_[idx(c[j])], &b = place_[idx(c[k])];
      star.wedges.push_back(
          {a, b, a.cross(b), cost.area, cost.opposite2[i], cost.opposite2[j], cost.opposite2[k], cost.dirichlet});
    }
    return star;
  }

  // Puts a vertex into the kernel of its ring: the directions from which all of the ring is seen. `kept` is a corner.
  void insert(const Collapse& c) {
    const Vec3 n = place_[idx(c.kept)];
    const Vec3 t1 = n.unitOrthogonal(), t2 = n.cross(t1);
    Polygon kernel{{-8.0, -8.0}, {8.0, -8.0}, {8.0, 8.0}, {-8.0, 8.0}};
    for (const int t : collapsed_.triangles_at(c.gone)) {
      const auto& corner = collapsed_.triangle(t);
      const std::size_t i = corner[0] == c.gone ? 0 : corner[1] == c.gone ? 1 : 2;
      const int a = corner[(i + 1) % 3], b = corner[(i + 2) % 3];
      const Vec3 normal = place_[idx(a)].cross(place_[idx(b)]);
      const double at_kept = a == c.kept || b == c.kept ? 0.0 : normal.dot(n);
      kernel = clipped(kernel, at_kept, {normal.dot(t1), normal.dot(t2)});
    }
    if (kernel.size() < 3) throw BadData("spherical map (mesh): a vertex found no place; the mesh is too badly shaped");
    Eigen::Vector2d centre = Eigen::Vector2d::Zero();
    for (const auto& p : kernel) centre += p / static_cast<double>(kernel.size());
    place_[idx(c.gone)] = (n + centre.x() * t1 + centre.y() * t2).normalized();
    relax(c.gone);
    relax(c.gone);
    for (const int t : collapsed_.triangles_at(c.gone)) {
      const auto& corner = collapsed_.triangle(t);
      const std::size_t i = corner[0] == c.gone ? 0 : corner[1] == c.gone ? 1 : 2;
      relax(corner[(i + 1) % 3]);
    }
    relax(c.gone);
  }

  // One damped Newton step of one vertex; returns how far it went.
  double relax(int v) {
    const Star star = star_of(v);
    Vec3& p = place_[idx(v)];
    const double before = star.energy(p);
    if (!std::isfinite(before)) return 0.0;
    Vec3 g3;
    Mat3 H3;
    star.differentiate(p, g3, H3);
    Eigen::Matrix<double, 3, 2> T;
    T.col(0) = p.unitOrthogonal();
    T.col(1) = p.cross(T.col(0));
    const Eigen::Vector2d g = T.transpose() * g3;
    // E depends on |p| as well: what the sphere's curvature adds.
    Eigen::Matrix2d H = T.transpose() * H3 * T - g3.dot(p) * Eigen::Matrix2d::Identity();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(H);
    const double top = eigen.eigenvalues().cwiseAbs().maxCoeff();
    if (!(top > 0.0)) return 0.0;
    const Eigen::Vector2d scale = eigen.eigenvalues().cwiseAbs().cwiseMax(1e-6 * top).cwiseInverse();
    const Eigen::Vector2d step = -(eigen.eigenvectors() * scale.asDiagonal() * eigen.eigenvectors().transpose() * g);
    double fraction = std::min(1.0, 0.5 / std::max(step.norm(), 1e-300));
    for (int attempt = 0; attempt < 8; ++attempt, fraction *= 0.4) {
      const Vec3 trial = (p + T * (fraction * step)).normalized();
      if (star.energy(trial) < before) {
        const double moved = (trial - p).norm();
        p = trial;
        return moved;
      }
    }
    return 0.0;
  }

  void relax_all(int sweeps) {
    area_ = 0.0;
    for (int t = 0; t < collapsed_.all_triangles(); ++t) {
      if (!collapsed_.has_triangle(t)) continue;
      const auto& c = collapsed_.triangle(t);
      area_ += 0.5 * (mesh_.vertices[idx(c[1])] - mesh_.vertices[idx(c[0])])
                         .cross(mesh_.vertices[idx(c[2])] - mesh_.vertices[idx(c[0])])
                         .norm();
    }
    std::vector<int> present;
    for (int v = 0; v < collapsed_.all_vertices(); ++v) {
      if (collapsed_.has_vertex(v)) present.push_back(v);
    }
    const double mean_edge = std::sqrt(8.0 * std::numbers::pi / static_cast<double>(present.size()));
    for (int s = 0; s < sweeps; ++s) {
      double moved = 0.0;
      // In alternating order, so that no end of the mesh is always last.
      if (s % 2 == 0) {
        for (const int v : present) moved += relax(v);
      } else {
        for (auto v = present.rbegin(); v != present.rend(); ++v) moved += relax(*v);
      }
      if (moved < 1e-4 * mean_edge * static_cast<double>(present.size())) break;
    }
  }

  // To first order x = c + A d; with A = U S V^T the directions become V^T d, so that the map does not depend on how
  // the object lies in the world. U and V are unique up to half turns about the axes.
  static void turn_to_axes(SphereMap& map) {
    Mat3 spread = Mat3::Zero(), cross = Mat3::Zero();
    Vec3 mean_d = Vec3::Zero(), mean_x = Vec3::Zero();
    double total = 0.0;
    std::vector<double> area(map.direction.size(), 0.0);
    for (const auto& t : map.mesh.triangles) {
      const double a = spherical_area(map.direction[idx(t[0])], map.direction[idx(t[1])], map.direction[idx(t[2])]);
      for (const int v : t) area[idx(v)] += a / 3.0;
    }
    for (std::size_t v = 0; v < area.size(); ++v) {
      mean_d += area[v] * map.direction[v];
      mean_x += area[v] * map.mesh.vertices[v];
      total += area[v];
    }
    for (std::size_t v = 0; v < area.size(); ++v) {
      const Vec3 d = map.direction[v] - mean_d / total;
      spread += area[v] * d * d.transpose();
      cross += area[v] * (map.mesh.vertices[v] - mean_x / total) * d.transpose();
    }
    const Mat3 A = cross * spread.inverse();
    Mat3 V = Eigen::SelfAdjointEigenSolver<Mat3>(A.transpose() * A).eigenvectors();
    if (!V.allFinite()) return;
    if (V.determinant() < 0.0) V.col(0) = -V.col(0);
    for (Vec3& d : map.direction) d = (V.transpose() * d).normalized();
  }

  SphereMap result() {
    importance_.assign(importance_.size(), 1.0);  // the stretch in the result is the unweighted one
    SphereMap map;
    std::vector<int> number(mesh_.vertices.size(), -1);
    for (int v = 0; v < collapsed_.all_vertices(); ++v) {
      if (!collapsed_.has_vertex(v)) continue;
      number[idx(v)] = static_cast<int>(map.mesh.vertices.size());
      map.mesh.vertices.push_back(mesh_.vertices[idx(v)]);
      map.direction.push_back(place_[idx(v)]);
    }
    double area = 0.0, energy = 0.0;
    for (int t = 0; t < collapsed_.all_triangles(); ++t) {
      if (!collapsed_.has_triangle(t)) continue;
      const auto& c = collapsed_.triangle(t);
      map.mesh.triangles.push_back({number[idx(c[0])], number[idx(c[1])], number[idx(c[2])]});
      const TriangleCost cost = cost_of(t, 0.0);
      const Vec3 &p = place_[idx(c[0])], &a = place_[idx(c[1])], &b = place_[idx(c[2])];
      Star star;
      star.wedges.push_back(
          {a, b, a.cross(b), cost.area, cost.opposite2[0], cost.opposite2[1], cost.opposite2[2], 0.0});
      energy += star.energy(p);
      area += cost.area;
      if (!(spherical_area(p, a, b) > 0.0))
        throw BadData("spherical map (mesh): a facet folded; the mesh is too badly shaped");
    }
    turn_to_axes(map);
    map.stretch = energy * 4.0 * std::numbers::pi / (area * area);
    return map;
  }

  const TriangleMesh& mesh_;
  const SphereMapSettings& settings_;
  const Observer& observer_;
  CollapsedMesh collapsed_;
  std::vector<Vec3> place_;
  std::vector<double> importance_;
  double area_ = 0.0;
};

}  // namespace

SphereMap map_to_sphere(const TriangleMesh& mesh, const SphereMapSettings& settings, const Observer& observer) {
  check_indices(mesh);
  const MeshTopology topology = topology_of(mesh);
  if (!topology.closed || !topology.manifold || !topology.oriented) {
    throw BadData(fmt::format("spherical map (mesh): it is not a closed surface ({})", topology.first_fault));
  }
  if (topology.components != 1 || topology.genus != 0) {
    throw BadData(fmt::format("spherical map (mesh): it has {} parts of genus {} in all; one of genus 0 is needed",
                              topology.components, topology.genus));
  }
  std::vector<int> number(mesh.vertices.size(), -1);
  TriangleMesh used;
  for (const auto& t : mesh.triangles) {
    std::array<int, 3> renumbered{};
    for (std::size_t i = 0; i < 3; ++i) {
      int& n = number[idx(t[i])];
      if (n < 0) {
        n = static_cast<int>(used.vertices.size());
        used.vertices.push_back(mesh.vertices[idx(t[i])]);
      }
      renumbered[i] = n;
    }
    used.triangles.push_back(renumbered);
  }
  return Mapper(used, settings, observer).run();
}

}  // namespace pellicle
