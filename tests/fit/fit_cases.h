#pragma once
/// Phantoms and measures that the fit tests share. Small and few-voxel: a fit takes well below a second.

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "pellicle/fit/fit.h"
#include "pellicle/mask/overlap.h"
#include "pellicle/mesh/distance.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/raster/rasterize.h"
#include "pellicle/synthetic/phantom.h"

namespace pellicle::test {

/// 48^3 voxels of 1 mm, radius 12, no noise, blur of a voxel.
inline PhantomSettings small_phantom(const std::string& shape = "sphere") {
  PhantomSettings s;
  s.shape = shape;
  s.size = {48, 48, 48};
  s.radius = {12.0};
  s.noise = PhantomNoise::none;
  return s;
}

inline FitResult fit_ball_seed(const Image<float>& image, const Vec3& centre, double radius,
                               const FitOptions& settings = {}) {
  return fit_surface({image, {Seed(SeedSphere{centre, radius})}}, settings);
}

inline double assd(const Surface& surface, const TriangleMesh& truth) {
  return surface_distances(tessellate(surface, 5), truth, 1.0, 4000).assd;
}

inline double dice(const Surface& surface, const Image<std::uint8_t>& truth) {
  return overlap_of(truth, rasterize_mask(tessellate(surface, 4), truth.grid)).dice;
}

inline double volume(const Surface& surface) {
  return volume_with_normals(tessellate(surface, 4));
}

inline double radius(const Surface& surface) {
  return std::cbrt(3.0 * volume(surface) / (4.0 * std::numbers::pi));
}

inline bool finite(const Surface& surface) {
  for (const double p : surface.parameters) {
    if (!std::isfinite(p)) return false;
  }
  return true;
}

/// One stage from the seed as it is, for tests of single energies.
inline FitOptions one_stage(Stage stage) {
  FitOptions settings;
  settings.start_rule = StartRule::sphere;
  settings.similarity = false;
  settings.stages = {std::move(stage)};
  return settings;
}

}  // namespace pellicle::test
