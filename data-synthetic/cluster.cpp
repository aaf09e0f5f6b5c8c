#include "pellicle/synthetic/cluster.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "pellicle/base/errors.h"
#include "pellicle/synthetic/degrade.h"
#include "pellicle/synthetic/implicit_mesh.h"
#include "pellicle/synthetic/internal/requirement.h"
#include "pellicle/synthetic/render.h"

namespace pellicle {
namespace {

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

/// Indices at which the centre of an object of radius r may lie: all of the object is inside the volume.
std::pair<Vec3, Vec3> room_for(const ClusterSettings& s, const ImageGrid& grid, double r) {
  const double longest = r * std::cbrt(s.elongation * s.elongation);
  const Vec3 low = longest * grid.spacing.cwiseInverse();
  const Vec3 high = Vec3(grid.size[0] - 1, grid.size[1] - 1, grid.size[2] - 1) - low;
  if (((high - low).array() < 0.0).any()) {
    throw SettingError(
        "volume too small", "size", fmt::format("{},{},{}", grid.size[0], grid.size[1], grid.size[2]),
        fmt::format("an object of half axis {:.4g} mm does not fit; use more voxels or a smaller `radius`", longest));
  }
  return {low, high};
}

Vec3 draw_center(const ClusterSettings& s, const ImageGrid& grid, double r, const std::vector<Vec3>& centers,
                 const std::vector<double>& radii, RandomEngine& random) {
  const auto [low, high] = room_for(s, grid, r);
  for (int attempt = 0; attempt < 200000; ++attempt) {
    Vec3 index;
    for (int a = 0; a < 3; ++a) index[a] = random.uniform(low[a], high[a]);
    Vec3 x = grid.world_from_index(index);
    bool free = true;
    for (std::size_t j = 0; j < centers.size() && free; ++j) {
      free = (x - centers[j]).norm() >= s.distance * (r + radii[j]);
    }
    if (free) return x;
  }
  throw SettingError("no room for all objects", "count", fmt::format("{}", s.count),
                     fmt::format("only {} found a place with centres {} (r + r') apart; use a larger volume, a smaller "
                                 "`radius` or a smaller `distance`",
                                 centers.size(), s.distance));
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

/// As for the other phantoms: within 0.4 inner radii of the centre, radius 0.25 to 1.2 inner radii.
SeedDraw draw_seed(const Body& body, RandomEngine& random) {
  const double inner = half_bounds(body.shape).minCoeff();
  Vec3 offset;
  do {
    for (int a = 0; a < 3; ++a) offset[a] = random.uniform(-1.0, 1.0);
  } while (offset.norm() > 1.0);
  return {body.center + 0.4 * inner * offset, inner * random.uniform(0.25, 1.2)};
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
  // It only says which voxels the surface passes: far coarser than a truth mesh.
  const TriangleMesh surface = mesh_of(body, bounds.minCoeff() / 6.0);
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

void ClusterSettings::validate() const {
  image.validate();
  const auto finite = [](double a, double b) { return std::isfinite(a) && std::isfinite(b); };
  require(count >= 1 && count <= 65535, "count", fmt::format("{}", count), "must lie between 1 and 65535");
  require(finite(radius_min, radius_max) && radius_min > 0.0 && radius_max >= radius_min, "radius",
          fmt::format("{},{}", radius_min, radius_max), "MIN,MAX must be above 0 and in this order, in mm");
  require(elongation >= 1.0 && elongation <= 10.0, "elongation", fmt::format("{}", elongation),
          "must lie between 1 and 10");
  require(distance > 0.0 && distance <= 100.0, "distance", fmt::format("{}", distance), "must lie in (0, 100]");
  require(finite(contrast_min, contrast_max) && contrast_min > 0.0 && contrast_max >= contrast_min, "contrast-range",
          fmt::format("{},{}", contrast_min, contrast_max), "MIN,MAX must be above 0 and in this order");
}

Cluster make_cluster(const ClusterSettings& settings) {
  settings.validate();
  const PhantomSettings& s = settings.image;
  const ImageGrid grid = phantom_grid(s);
  RandomEngine random(s.seed ^ 0xc1u);
  const std::vector<double> radii = draw_radii(settings, random);
  Cluster cluster;
  cluster.settings = settings;
  std::vector<Vec3> centers;
  RandomEngine random_of_seeds(s.seed ^ 0x5eedULL);
  for (const double r : radii) {
    centers.push_back(draw_center(settings, grid, r, centers, radii, random));
    cluster.bodies.push_back(draw_body(settings, r, centers.back(), random));
    const double exponent = random.uniform();
    cluster.contrast.push_back(settings.contrast_max *
                               std::pow(settings.contrast_min / settings.contrast_max, exponent));
  }
  for (const Body& body : cluster.bodies) cluster.seeds.push_back(draw_seed(body, random_of_seeds));
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
