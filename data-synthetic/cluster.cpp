#include "pellicle/synthetic/cluster.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "pellicle/base/errors.h"
#include "pellicle/synthetic/degrade.h"
#include "pellicle/synthetic/implicit_mesh.h"
#include "pellicle/synthetic/inner_ball.h"
#include "pellicle/synthetic/render.h"

namespace pellicle {
namespace {

void validate(const ClusterSettings& s) {
  s.image.validate();
  if (s.count < 1 || s.count > 65535) throw UsageError(fmt::format("bad cluster: {} objects, 1 to 65535", s.count));
  if (!(s.radius_min > 0.0) || !(s.radius_max >= s.radius_min) || !(s.elongation >= 1.0) || !(s.distance > 0.0) ||
      !(s.contrast_min > 0.0) || !(s.contrast_min <= 1.0)) {
    throw UsageError("bad cluster: radii, elongation, distance or contrast out of range");
  }
}

Mat3 random_rotation(RandomEngine& random) {
  const Eigen::Vector4d q(random.normal(), random.normal(), random.normal(), random.normal());
  return Eigen::Quaterniond(q.normalized()).toRotationMatrix();
}

/// Largest first: small ones still find room when it gets tight.
std::vector<double> draw_radii(const ClusterSettings& s, RandomEngine& random) {
  std::vector<double> radii;
  radii.reserve(static_cast<std::size_t>(std::max(0, s.count)));
  for (int i = 0; i < s.count; ++i) radii.push_back(random.uniform(s.radius_min, s.radius_max));
  std::sort(radii.rbegin(), radii.rend());
  return radii;
}

Vec3 draw_center(const ClusterSettings& s, const ImageGrid& grid, double r, const std::vector<Vec3>& centers,
                 const std::vector<double>& radii, RandomEngine& random) {
  for (int attempt = 0; attempt < 200000; ++attempt) {
    Vec3 index;
    for (int a = 0; a < 3; ++a) {
      const double margin = r * std::cbrt(s.elongation * s.elongation) / grid.spacing[a];
      index[a] = random.uniform(margin, grid.size[static_cast<std::size_t>(a)] - 1 - margin);
      if (grid.size[static_cast<std::size_t>(a)] - 1 < 2.0 * margin) throw UsageError("bad cluster: volume too small");
    }
    Vec3 x = grid.world_from_index(index);
    bool free = true;
    for (std::size_t j = 0; j < centers.size() && free; ++j) {
      free = (x - centers[j]).norm() >= s.distance * (r + radii[j]);
    }
    if (free) return x;
  }
  throw UsageError(fmt::format("bad cluster: {} objects do not fit, {} did", s.count, centers.size()));
}

/// Axes with a : b : c = e : m : 1, m between, and the volume of the ball of radius r.
Body draw_body(const ClusterSettings& s, double r, const Vec3& center, RandomEngine& random) {
  const double e = random.uniform(1.0, s.elongation), m = random.uniform(1.0, e);
  Body body;
  body.shape = EllipsoidShape{r / std::cbrt(e * m) * Vec3(e, m, 1.0)};
  body.world_from_shape = random_rotation(random);
  body.center = center;
  return body;
}

/// The part of `grid` that the object and its blur can reach; `first` is its corner.
ImageGrid window_of(const ImageGrid& grid, const Vec3& center, double reach, Index3& first) {
  const Vec3 middle = grid.index_from_world(center);
  ImageGrid window = grid;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<Eigen::Index>(a);
    const double half = reach / grid.spacing[axis];
    first[a] = std::clamp(static_cast<int>(std::floor(middle[axis] - half)), 0, grid.size[a] - 2);
    const int last = std::clamp(static_cast<int>(std::ceil(middle[axis] + half)), first[a] + 1, grid.size[a] - 1);
    window.size[a] = last - first[a] + 1;
  }
  window.origin_in_world = grid.world_from_index(Vec3(first[0], first[1], first[2]));
  return window;
}

struct Painted {
  Image<float> fraction;       ///< sum of contrast * fraction
  std::vector<float> deepest;  ///< level value of the label's body
};

void paint(const Body& body, double contrast, std::uint16_t label, double blur_mm, Painted& painted,
           Image<std::uint16_t>& truth) {
  const Vec3 bounds = half_bounds(body.shape);
  const ImageGrid& grid = truth.grid;
  Index3 first{0, 0, 0};
  const double reach = bounds.maxCoeff() + 4.0 * blur_mm + grid.spacing.maxCoeff();
  const ImageGrid window = window_of(grid, body.center, reach, first);
  const TriangleMesh surface = mesh_of(body, mesh_cell(body.shape));
  const Image<float> fraction = fraction_of(body, surface, window, 0.0, blur_mm);
  std::size_t v = 0;
  for (int k = 0; k < window.size[2]; ++k) {
    for (int j = 0; j < window.size[1]; ++j) {
      for (int i = 0; i < window.size[0]; ++i, ++v) {
        const int x = first[0] + i, y = first[1] + j, z = first[2] + k;
        const std::size_t at =
            static_cast<std::size_t>(x) +
            static_cast<std::size_t>(grid.size[0]) *
                (static_cast<std::size_t>(y) + static_cast<std::size_t>(grid.size[1]) * static_cast<std::size_t>(z));
        painted.fraction.voxels[at] += static_cast<float>(contrast) * fraction.voxels[v];
        if (fraction.voxels[v] <= 0.0F) continue;
        const auto depth = static_cast<float>(body.level_at(grid.world_from_index(Vec3(x, y, z))).value);
        if (depth < painted.deepest[at]) {
          painted.deepest[at] = depth;
          truth.voxels[at] = label;
        }
      }
    }
  }
}

}  // namespace

Cluster make_cluster(const ClusterSettings& settings) {
  validate(settings);
  const PhantomSettings& s = settings.image;
  const ImageGrid grid = phantom_grid(s);
  RandomEngine random(s.seed ^ 0xc1u);
  const std::vector<double> radii = draw_radii(settings, random);
  Cluster cluster;
  std::vector<Vec3> centers;
  for (const double r : radii) {
    centers.push_back(draw_center(settings, grid, r, centers, radii, random));
    cluster.bodies.push_back(draw_body(settings, r, centers.back(), random));
    cluster.contrast.push_back(std::pow(settings.contrast_min, random.uniform()));
  }
  std::size_t voxels = 1;
  for (const int n : grid.size) voxels *= static_cast<std::size_t>(n);
  cluster.truth.grid = grid;
  cluster.truth.voxels.assign(voxels, 0);
  Painted painted;
  painted.fraction.grid = grid;
  painted.fraction.voxels.assign(voxels, 0.0F);
  painted.deepest.assign(voxels, 0.0F);
  for (std::size_t i = 0; i < cluster.bodies.size(); ++i) {
    paint(cluster.bodies[i], cluster.contrast[i], static_cast<std::uint16_t>(i + 1), s.blur_mm, painted, cluster.truth);
  }
  const double step = s.inside - s.outside;
  cluster.image = std::move(painted.fraction);
  for (float& value : cluster.image.voxels) value = static_cast<float>(s.outside + step * value);
  apply_bias(cluster.image, s.bias, s.seed);
  apply_noise(cluster.image, s.noise, std::abs(step) / s.snr, std::max(s.inside, s.outside), s.seed);
  return cluster;
}

}  // namespace pellicle
