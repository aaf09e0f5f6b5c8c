#include "pellicle/fit/many/many_piece.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "pellicle/energies/profiles.h"
#include "pellicle/mesh/measure.h"

namespace pellicle {

namespace {

constexpr double kCap = 2.2;         // furthest from the centroid, in typical radii
constexpr double kSmoothing = 0.08;  // of the image forces, in typical radii

/// Voxels of the territories' grid about a place.
IndexBox box_about(const ImageGrid& grid, const Vec3& x, double reach) {
  return box_around(grid, x - Vec3::Constant(reach), x + Vec3::Constant(reach), 0.0);
}

}  // namespace

std::pair<SurfaceModel, int> model_of_many(const FitOptions& settings) {
  SurfaceModel model = start_model(settings.model);
  Surface surface{model, affine_image(model, Vec3::Zero(), Mat3::Identity())};
  int detail = 0;
  // About 26 control points: enough for the shape of a nucleus, few enough for thousands of them.
  const auto enough = [&] {
    return settings.detail ? detail >= *settings.detail : control_point_count(surface.model) >= 20;
  };
  while (!enough()) {
    surface = refine(surface);
    ++detail;
  }
  return {surface.model, detail};
}

Territory territory_of(const ManyScene& scene, std::size_t object, const ManyStart& start) {
  const Image<std::int32_t>& all = scene.territories;
  const double reach = kCap * scene.radius, near = 0.8 * scene.radius;
  const IndexBox box = box_about(all.grid, start.position, reach + 2.0 * all.grid.spacing.maxCoeff());
  Territory t;
  t.own.grid = all.grid;
  t.own.grid.size = box.size;
  t.own.grid.origin_in_world = all.grid.world_from_index(Vec3(box.begin[0], box.begin[1], box.begin[2]));
  t.own.voxels.resize(t.own.grid.voxel_count(), 0.0F);
  t.low = t.high = t.centre = start.position;
  const auto label = static_cast<std::int32_t>(object) + 1;
  Vec3 sum = Vec3::Zero();
  std::size_t count = 0;
  for (int k = 0; k < box.size[2]; ++k) {
    for (int j = 0; j < box.size[1]; ++j) {
      for (int i = 0; i < box.size[0]; ++i) {
        if (all.at(box.begin[0] + i, box.begin[1] + j, box.begin[2] + k) != label) continue;
        t.own.at(i, j, k) = 1.0F;
        const Vec3 x = t.own.grid.world_from_index(Vec3(i, j, k));
        const double apart = (x - start.position).norm();
        if (apart > reach) continue;
        t.low = t.low.cwiseMin(x);
        t.high = t.high.cwiseMax(x);
        if (apart > near) continue;
        sum += x;
        ++count;
      }
    }
  }
  if (count > 0) t.centre = sum / static_cast<double>(count);
  t.radius = std::cbrt(3.0 * static_cast<double>(count) * all.grid.voxel_volume() / (4.0 * std::numbers::pi));
  return t;
}

Image<float> piece_of(const ManyScene& scene, const Territory& territory, Intensities intensities) {
  const IndexBox box = box_around(scene.image.grid, territory.low, territory.high, 0.3 * scene.radius);
  Image<float> piece = crop_and_bin(scene.image, box, {1, 1, 1});
  const StableIntensity& intensity = scene.field.intensity;
  for (float& v : piece.voxels) v = intensities == Intensities::stabilised ? intensity(v) : intensity.linear(v);
  return piece;
}

Image<float> smoothed_for_many(Image<float> image, const FitOptions& settings, double radius) {
  const Index3 factor = bin_factors(image.grid, radius / 16.0);
  if (!(factor == Index3{1, 1, 1})) image = crop_and_bin(image, {{0, 0, 0}, image.grid.size}, factor);
  return gaussian_smooth(std::move(image), settings.smoothing_mm.value_or(kSmoothing * radius));
}

Candidate start_of(const ManyScene& scene, const ManyStart& start, const Territory& territory) {
  Candidate state{.surface = {scene.model, {}}, .detail = scene.detail};
  if (start.surface) {
    state.surface = *start.surface;
    state.detail = refinements_of(start.surface->model);
  } else if (start.radius) {
    const double r = std::clamp(*start.radius, 0.4 * scene.radius, 1.2 * scene.radius);
    state.surface.parameters = affine_image(scene.model, start.position, r * Mat3::Identity());
  } else {
    const double r = std::clamp(territory.radius, 0.4 * scene.radius, 0.8 * scene.radius);
    state.surface.parameters = affine_image(scene.model, territory.centre, r * Mat3::Identity());
  }
  state.reading.name = "one of many";
  return state;
}

double typical_radius_of_seeds(const std::vector<Seed>& seeds) {
  std::vector<double> radii;
  radii.reserve(seeds.size());
  for (const Seed& seed : seeds) {
    const auto* ball = std::get_if<SeedSphere>(&seed);
    if (ball != nullptr) {
      radii.push_back(ball->radius);
    } else {
      const TriangleMesh mesh = tessellate(std::get<Surface>(seed), 2);
      radii.push_back(std::cbrt(3.0 * std::abs(volume_with_normals(mesh)) / (4.0 * std::numbers::pi)));
    }
  }
  return median_of(std::move(radii));
}

Vec3 middle_of(const Seed& seed) {
  const auto* ball = std::get_if<SeedSphere>(&seed);
  if (ball != nullptr) return ball->center;
  Vec3 sum = Vec3::Zero();
  const TriangleMesh mesh = tessellate(std::get<Surface>(seed), 2);
  for (const Vec3& v : mesh.vertices) sum += v;
  return sum / static_cast<double>(mesh.vertices.size());
}

std::vector<bool> without_repeats(const std::vector<Seed>& seeds, const Image<float>& response, double radius) {
  const TrilinearField field(response);
  std::vector<Vec3> accepted;
  std::vector<bool> own;
  own.reserve(seeds.size());
  accepted.reserve(seeds.size());
  for (const Seed& seed : seeds) {
    const Vec3 x = middle_of(seed);
    const bool repeats = std::any_of(accepted.begin(), accepted.end(), [&](const Vec3& other) {
      const double apart = (x - other).norm();
      if (apart >= radius) return false;
      if (apart < 0.5 * radius) return true;
      std::array<float, 17> line{};
      field.along_line(x, (other - x) / 16.0, 17, line.data());
      const float lowest = *std::min_element(line.begin(), line.end());
      return static_cast<double>(lowest) >= 0.9 * static_cast<double>(std::min(line.front(), line.back()));
    });
    own.push_back(!repeats);
    if (!repeats) accepted.push_back(x);
  }
  return own;
}

}  // namespace pellicle
