#include "pellicle/mesh/measure.h"

#include <fmt/format.h>

#include <cmath>

#include "pellicle/base/errors.h"

namespace pellicle {

namespace {

// Sums are taken about a point of the mesh: far from the origin the divergence theorem would cancel large terms.
Vec3 reference_of(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return Vec3::Zero();
  return mesh.vertices[static_cast<std::size_t>(mesh.triangles[0][0])];
}

struct Corners {
  Vec3 a, b, c;
};

Corners corners_of(const TriangleMesh& mesh, const std::array<int, 3>& t, const Vec3& reference) {
  const auto vertex = [&](std::size_t i) -> Vec3 { return mesh.vertices[static_cast<std::size_t>(t[i])] - reference; };
  return {vertex(0), vertex(1), vertex(2)};
}

// G of models.md 1.2 and its derivatives: handle length over sine, continued below z* by its Taylor polynomial.
double handle_gain(double z) {
  constexpr double kStart = 0.04;
  const auto plain = [](double c) { return 1.0 / (c * (1.0 + c)); };
  if (z >= kStart) return plain(std::sqrt(z));
  const double c = std::sqrt(kStart);
  const double u = c + kStart, du = 1.0 / (2.0 * c) + 1.0, ddu = -1.0 / (4.0 * c * kStart);
  const double g = 1.0 / u, dg = -du / (u * u), ddg = 2.0 * du * du / (u * u * u) - ddu / (u * u);
  const double step = z - kStart;
  return g + dg * step + 0.5 * ddg * step * step;
}

}  // namespace

void check_indices(const TriangleMesh& mesh) {
  const auto count = static_cast<int>(mesh.vertices.size());
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    for (const int i : mesh.triangles[f]) {
      if (i < 0 || i >= count) {
        throw BadData(fmt::format("mesh (triangle {}): vertex {} does not exist, there are {}", f, i, count));
      }
    }
  }
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (!mesh.vertices[v].allFinite()) throw BadData(fmt::format("mesh (vertex {}): a coordinate is not finite", v));
  }
}

double area_of(const TriangleMesh& mesh) {
  const Vec3 reference = reference_of(mesh);
  double twice = 0.0;
  for (const auto& t : mesh.triangles) {
    const auto [a, b, c] = corners_of(mesh, t, reference);
    twice += (b - a).cross(c - a).norm();
  }
  return 0.5 * twice;
}

double volume_of(const TriangleMesh& mesh) {
  const Vec3 reference = reference_of(mesh);
  double six = 0.0;
  for (const auto& t : mesh.triangles) {
    const auto [a, b, c] = corners_of(mesh, t, reference);
    six += a.dot(b.cross(c));
  }
  return six / 6.0;
}

void turn_outward(TriangleMesh& mesh) {
  if (volume_of(mesh) >= 0.0) return;
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  for (auto& normal : mesh.normals) normal = -normal;
}

double volume_with_normals(const TriangleMesh& mesh) {
  if (mesh.normals.size() != mesh.vertices.size()) {
    throw BadData("volume with normals (mesh): the mesh has no vertex normals");
  }
  double correction = 0.0;
  for (const auto& t : mesh.triangles) {
    const auto point = [&](std::size_t i) -> const Vec3& { return mesh.vertices[static_cast<std::size_t>(t[i])]; };
    const Vec3 area = 0.5 * (point(1) - point(0)).cross(point(2) - point(0));
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3& n = mesh.normals[static_cast<std::size_t>(t[i])];
      for (std::size_t j = 0; j < 3; ++j) {
        if (i == j) continue;
        const Vec3 e = point(j) - point(i);
        const double rise = n.dot(e), length2 = e.squaredNorm();
        if (!(length2 > 0.0)) continue;
        const double z = std::max(0.0, 1.0 - rise * rise / length2);
        correction += handle_gain(z) * (e - rise * n).dot(area);
      }
    }
  }
  return volume_of(mesh) + correction / 12.0;  // (1/8)(2/3)
}

Vec3 centroid_of(const TriangleMesh& mesh) {
  Vec3 reference = reference_of(mesh);
  Vec3 first = Vec3::Zero(), sum = Vec3::Zero();
  double six = 0.0, size = 0.0;
  for (const auto& t : mesh.triangles) {
    const auto [a, b, c] = corners_of(mesh, t, reference);
    const double v = a.dot(b.cross(c));
    six += v;
    size += std::abs(v);
    first += v * (a + b + c) / 4.0;
    sum += (a + b + c) / 3.0;
  }
  if (mesh.triangles.empty()) return reference;
  // Nothing enclosed: the mean of the facets is all there is.
  if (std::abs(six) <= 1e-12 * size) return reference + sum / static_cast<double>(mesh.triangles.size());
  return reference + first / six;
}

}  // namespace pellicle
