#include "pellicle/synthetic/phantom.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pellicle/base/errors.h"
#include "pellicle/synthetic/degrade.h"
#include "pellicle/synthetic/implicit_mesh.h"
#include "pellicle/synthetic/inner_ball.h"
#include "pellicle/synthetic/internal/requirement.h"
#include "pellicle/synthetic/render.h"

namespace pellicle {
namespace {

/// About x, then y, then z (fixed axes), degrees.
Mat3 rotation_of(const Vec3& degrees) {
  const Vec3 angle = degrees * (std::numbers::pi / 180.0);
  return (Eigen::AngleAxisd(angle.z(), Vec3::UnitZ()) * Eigen::AngleAxisd(angle.y(), Vec3::UnitY()) *
          Eigen::AngleAxisd(angle.x(), Vec3::UnitX()))
      .toRotationMatrix();
}

std::string text(const Vec3& v) {
  return fmt::format("{},{},{}", v.x(), v.y(), v.z());
}

double shell_thickness(const PhantomSettings& settings, const ImageGrid& grid, double inner_radius) {
  if (settings.fill == PhantomFill::solid) return 0.0;
  const double largest = 1.2 * inner_radius;
  require(settings.shell_thickness_mm <= largest, "shell-thickness", fmt::format("{}", settings.shell_thickness_mm),
          "must be at most 1.2 times the shape's inner radius");
  if (settings.shell_thickness_mm > 0.0) return settings.shell_thickness_mm;
  return std::min(3.0 * grid.mean_spacing(), 0.6 * inner_radius);
}

Image<float> degraded(Image<float> fraction, const PhantomSettings& settings) {
  const auto low = settings.outside, contrast = settings.inside - settings.outside;
  for (float& value : fraction.voxels) value = static_cast<float>(low + contrast * value);
  apply_bias(fraction, settings.bias, settings.seed);
  const double reference = std::max(settings.inside, settings.outside);
  apply_noise(fraction, settings.noise, std::abs(contrast) / settings.snr, reference, settings.seed);
  return fraction;
}

}  // namespace

ImageGrid phantom_grid(const PhantomSettings& settings) {
  ImageGrid grid;
  grid.size = settings.size;
  grid.spacing = settings.spacing;
  grid.direction = rotation_of(settings.direction_degrees);
  const Vec3 middle = 0.5 * Vec3(grid.size[0] - 1, grid.size[1] - 1, grid.size[2] - 1);
  grid.origin_in_world = -(grid.world_from_index_matrix() * middle);
  return grid;
}

void PhantomSettings::validate() const {
  make_shape(shape, radius, blob_amplitude, seed);
  const auto whole = fmt::format("{},{},{}", size[0], size[1], size[2]);
  double voxels = 1.0;
  for (const int n : size) {
    require(n >= 2 && n <= 8192, "size", whole, "each number must lie between 2 and 8192");
    voxels *= n;
  }
  require(voxels <= 2147483648.0, "size", whole, "at most 2^31 voxels");
  require(spacing.allFinite() && spacing.minCoeff() > 0.0, "spacing", text(spacing), "must be above 0, in mm");
  require(direction_degrees.allFinite(), "direction", text(direction_degrees), "must be finite");
  require(center.allFinite(), "center", text(center), "must be finite");
  require(blob_amplitude > 0.0 && blob_amplitude <= 0.6, "amplitude", fmt::format("{}", blob_amplitude),
          "must lie in (0, 0.6]");
  require(std::isfinite(shell_thickness_mm) && shell_thickness_mm >= 0.0, "shell-thickness",
          fmt::format("{}", shell_thickness_mm), "must be 0 (automatic) or above, in mm");
  const auto levels = fmt::format("{},{}", inside, outside);
  require(std::isfinite(inside) && std::isfinite(outside) && inside != outside, "contrast", levels,
          "inside and outside must be finite and differ");
  require(noise != PhantomNoise::poisson || (inside >= 0.0 && outside >= 0.0), "contrast", levels,
          "Poisson noise needs intensities of 0 or more");
  const double longest = phantom_grid(*this).extent().maxCoeff();
  require(blur_mm >= 0.0 && blur_mm <= longest, "blur", fmt::format("{}", blur_mm),
          "must lie between 0 and the volume's longest edge, in mm");
  require(noise == PhantomNoise::none || (std::isfinite(snr) && snr > 0.0), "snr", fmt::format("{}", snr),
          "must be above 0");
  require(bias >= 0.0 && bias < 1.0, "bias", fmt::format("{}", bias), "must lie in [0, 1)");
}

Phantom make_phantom(const PhantomSettings& settings) {
  settings.validate();
  Phantom phantom;
  phantom.settings = settings;
  phantom.body.shape = make_shape(settings.shape, settings.radius, settings.blob_amplitude, settings.seed);
  // A fixed pose unlike every grid axis and every symmetry of the control meshes.
  phantom.body.world_from_shape = rotation_of({25.0, -35.0, 55.0});
  phantom.body.center = settings.center;
  const double volume = exact_volume(phantom.body.shape);
  phantom.exact_volume_ml = volume / 1000.0;
  phantom.truth_surface = mesh_of(phantom.body, mesh_cell(phantom.body.shape));
  const InnerBall ball = inner_ball(phantom.body, phantom.truth_surface);
  phantom.inner_radius = ball.radius;
  phantom.natural_center = ball.natural_center;

  const ImageGrid grid = phantom_grid(settings);
  phantom.shell_thickness_mm = shell_thickness(settings, grid, phantom.inner_radius);
  phantom.truth = mask_of(phantom.body, phantom.truth_surface, grid);
  if (std::find(phantom.truth.voxels.begin(), phantom.truth.voxels.end(), 1) == phantom.truth.voxels.end()) {
    throw SettingError("the phantom is empty", "center", text(settings.center),
                       "no voxel centre lies inside the object; move it into the volume or use smaller voxels");
  }
  phantom.image = degraded(
      fraction_of(phantom.body, phantom.truth_surface, grid, phantom.shell_thickness_mm, settings.blur_mm), settings);
  RandomEngine random(settings.seed ^ 0x5eedULL);
  if (grid.contains(phantom.natural_center)) phantom.seeds = draw_seeds(phantom, 8, random);
  return phantom;
}

std::vector<SeedDraw> draw_seeds(const Phantom& phantom, int count, RandomEngine& random) {
  std::vector<SeedDraw> seeds;
  const double reach = 0.4 * phantom.inner_radius;
  for (int attempt = 0; attempt < 1000 * count && static_cast<int>(seeds.size()) < count; ++attempt) {
    const Vec3 offset(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
    const double size = random.uniform(0.25, 1.2);
    const Vec3 center = phantom.natural_center + reach * offset;
    if (offset.norm() > 1.0 || phantom.body.level_at(center).value >= 0.0 || !phantom.image.grid.contains(center)) {
      continue;
    }
    seeds.push_back({center, size * phantom.inner_radius});
  }
  return seeds;
}

}  // namespace pellicle
