#include "pellicle/picture/shaded_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace pellicle {

namespace {

constexpr Rgb background{24, 26, 32};
constexpr int supersampling = 2;

/// An orthographic camera: rows are picture right, picture down and away from the eye, in LPS.
Mat3 camera() {
  const Vec3 away = Vec3(-0.55, 0.75, -0.37).normalized();  // the eye is at the front left above
  const Vec3 right = Vec3(0, 0, 1).cross(-away).normalized();
  Mat3 rows;
  rows.row(0) = right;
  rows.row(1) = away.cross(right);
  rows.row(2) = away;
  return rows;
}

Rgb shade(const Vec3& normal) {
  const Vec3 to_light = Vec3(-0.35, -0.6, -0.72).normalized();  // upper left, behind the eye
  const Vec3 to_eye(0, 0, -1);
  const double facing = normal.dot(to_eye) < 0.0 ? -1.0 : 1.0;
  const double diffuse = std::max(0.0, facing * normal.dot(to_light));
  const Vec3 half = (to_light + to_eye).normalized();
  const double gloss = 0.25 * std::pow(std::max(0.0, facing * normal.dot(half)), 40.0);
  const Vec3 base(0.90, 0.66, 0.30);
  Rgb color{};
  for (int c = 0; c < 3; ++c) {
    const double value = base[c] * (0.22 + 0.78 * diffuse) + gloss;
    color[static_cast<std::size_t>(c)] = static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(value, 0.0, 1.0)));
  }
  return color;
}

std::vector<Vec3> normals_of(const TriangleMesh& mesh) {
  if (mesh.normals.size() == mesh.vertices.size()) return mesh.normals;
  std::vector<Vec3> normals(mesh.vertices.size(), Vec3::Zero());
  for (const auto& t : mesh.triangles) {
    const auto a = static_cast<std::size_t>(t[0]), b = static_cast<std::size_t>(t[1]),
               c = static_cast<std::size_t>(t[2]);
    const Vec3 area = (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
    for (const auto v : {a, b, c}) normals[v] += area;
  }
  return normals;
}

struct Target {
  Canvas canvas;
  std::vector<double> depth;
};

// x, y in pixels and depth in mm; normals in the camera's frame.
void fill_triangle(Target& target, const std::array<Vec3, 3>& corner, const std::array<Vec3, 3>& normal) {
  const double area = (corner[1] - corner[0]).head<2>().x() * (corner[2] - corner[0]).y() -
                      (corner[1] - corner[0]).y() * (corner[2] - corner[0]).x();
  if (!(std::abs(area) > 1e-12)) return;
  const auto low = [&](int a) {
    return static_cast<int>(std::ceil(std::min({corner[0][a], corner[1][a], corner[2][a]})));
  };
  const auto high = [&](int a) {
    return static_cast<int>(std::floor(std::max({corner[0][a], corner[1][a], corner[2][a]})));
  };
  const auto weight = [&](const Vec3& from, const Vec3& to, int x, int y) {
    return ((to.x() - from.x()) * (y - from.y()) - (to.y() - from.y()) * (x - from.x())) / area;
  };
  for (int y = std::max(0, low(1)); y <= std::min(target.canvas.height - 1, high(1)); ++y) {
    for (int x = std::max(0, low(0)); x <= std::min(target.canvas.width - 1, high(0)); ++x) {
      const double w0 = weight(corner[1], corner[2], x, y), w1 = weight(corner[2], corner[0], x, y);
      const double w2 = 1.0 - w0 - w1;
      if (w0 < 0.0 || w1 < 0.0 || w2 < 0.0) continue;
      const double depth = w0 * corner[0].z() + w1 * corner[1].z() + w2 * corner[2].z();
      double& nearest = target.depth[static_cast<std::size_t>(y) * static_cast<std::size_t>(target.canvas.width) +
                                     static_cast<std::size_t>(x)];
      if (depth >= nearest) continue;
      nearest = depth;
      const Vec3 n = w0 * normal[0] + w1 * normal[1] + w2 * normal[2];
      target.canvas.at(x, y) = shade(n.normalized());
    }
  }
}

Canvas averaged(const Canvas& fine) {
  Canvas coarse(fine.width / supersampling, fine.height / supersampling);
  for (int y = 0; y < coarse.height; ++y) {
    for (int x = 0; x < coarse.width; ++x) {
      for (std::size_t c = 0; c < 3; ++c) {
        int sum = 0;
        for (int s = 0; s < supersampling * supersampling; ++s) {
          const auto row = static_cast<std::size_t>(y * supersampling + s / supersampling);
          const auto column = static_cast<std::size_t>(x * supersampling + s % supersampling);
          sum += fine.pixels[row * static_cast<std::size_t>(fine.width) + column][c];
        }
        coarse.at(x, y)[c] = static_cast<std::uint8_t>(sum / (supersampling * supersampling));
      }
    }
  }
  return coarse;
}

/// Vertices in the camera's frame.
std::vector<Vec3> seen(const TriangleMesh& mesh) {
  const Mat3 view = camera();
  std::vector<Vec3> points;
  points.reserve(mesh.vertices.size());
  for (const auto& vertex : mesh.vertices) points.emplace_back(view * vertex);
  return points;
}

struct ViewBox {
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  double size() const { return std::max((high - low).x(), (high - low).y()); }
};

ViewBox box_of(const std::vector<Vec3>& points) {
  if (points.empty()) return {};
  ViewBox box{points.front(), points.front()};
  for (const auto& p : points) {
    box.low = box.low.cwiseMin(p);
    box.high = box.high.cwiseMax(p);
  }
  return box;
}

}  // namespace

double shaded_extent(const TriangleMesh& mesh) {
  return std::max(box_of(seen(mesh)).size(), 1e-9);
}

Canvas draw_shaded(const TriangleMesh& mesh, int size, std::optional<double> extent_mm) {
  const int fine = size * supersampling;
  Target target{Canvas(fine, fine, background),
                std::vector<double>(static_cast<std::size_t>(fine) * static_cast<std::size_t>(fine),
                                    std::numeric_limits<double>::max())};
  if (mesh.vertices.empty()) return averaged(target.canvas);
  std::vector<Vec3> points = seen(mesh);
  const ViewBox box = box_of(points);
  const double scale = 0.84 * fine / std::max(extent_mm.value_or(box.size()), 1e-9);
  const Vec3 middle = 0.5 * (box.low + box.high);
  for (auto& p : points) {
    p.x() = 0.5 * fine + (p.x() - middle.x()) * scale;
    p.y() = 0.5 * fine + (p.y() - middle.y()) * scale;
  }
  const Mat3 view = camera();
  const auto normals = normals_of(mesh);
  for (const auto& t : mesh.triangles) {
    std::array<Vec3, 3> corner, normal;
    for (std::size_t c = 0; c < 3; ++c) {
      corner[c] = points[static_cast<std::size_t>(t[c])];
      normal[c] = view * normals[static_cast<std::size_t>(t[c])];
    }
    fill_triangle(target, corner, normal);
  }
  return averaged(target.canvas);
}

}  // namespace pellicle
