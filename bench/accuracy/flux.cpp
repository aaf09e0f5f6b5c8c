#include "pellicle/energies/flux.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "pellicle/energies/geometry.h"
#include "pellicle/energies/region.h"
#include "pellicle/image/resample.h"
#include "pellicle/synthetic/phantom.h"
#include "sections.h"

namespace pellicle::bench {

namespace {

/// Both forms of the flux of one noisy ball's smoothed image.
struct Forms {
  std::array<Image<float>, 3> gradient;
  Image<float> antiderivative;

  double energy(bool preintegrated, const std::vector<Vec3>& x, const std::vector<Vec3>& area, std::vector<Vec3>& dx,
                std::vector<Vec3>& da) const {
    if (preintegrated) {
      const Vec3 axis = antiderivative.grid.direction.col(0);
      return region_integral(CubicField(antiderivative), axis, 1.0, x, area, dx, da);
    }
    const std::array<CubicField, 3> fields{CubicField(gradient[0]), CubicField(gradient[1]), CubicField(gradient[2])};
    return flux(fields, 1.0, x, area, dx, da);
  }
};

/// Derivative by the parameters, from the samples of one level.
std::vector<double> gradient_of(const Forms& forms, bool preintegrated, const NormalModel& model,
                                const Parameters& parameters, int level) {
  const SampleLayout layout = model.layout(level);
  SurfaceSamples samples;
  model.evaluate(parameters, layout, false, samples);
  std::vector<Vec3> dx(samples.x.size(), Vec3::Zero()), da = dx;
  forms.energy(preintegrated, samples.x, area_vectors(layout, samples.x), dx, da);
  pull_back_area_vectors(layout, samples.x, da, dx);
  std::vector<double> gradient(parameters.size(), 0.0);
  model.pull_back(parameters, layout, dx, gradient);
  return gradient;
}

/// |a - b|^2 and |b|^2 over the control points (normals have another unit).
std::pair<double, double> squares(const std::vector<double>& a, const std::vector<double>& b) {
  double error = 0.0, size = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (i % 6 >= 3) continue;
    error += (a[i] - b[i]) * (a[i] - b[i]);
    size += b[i] * b[i];
  }
  return {error, size};
}

}  // namespace

void flux_table() {
  constexpr double radius = 15.0;
  constexpr int seeds = 4, dense = 6;
  fmt::print(
      "\n## Flux through the surface and pre-integrated\n\nBall of radius {} voxels, blur 1, smoothed by 1 voxel; a "
      "lumpy "
      "surface of 42 control points half a voxel outside. Error of the derivative by the control points against that "
      "of "
      "the same form from samples 0.13 voxels apart, relative.\n\n| SNR | samples apart, voxels | surface | "
      "pre-integrated |\n|---|---|---|---|\n",
      radius);
  const NormalModel start = NormalModel::start(StartSolid::icosahedron, SubdivisionRule::smooth);
  const auto [model, sphere] = start.refine(start.reference());
  for (const double snr : {1e6, 5.0, 2.0}) {
    for (const int level : {2, 3, 4}) {
      double error[2] = {0.0, 0.0}, size[2] = {0.0, 0.0};
      for (int seed = 1; seed <= seeds; ++seed) {
        PhantomSettings s{.size = {64, 64, 64}, .radius = {radius}, .center = Vec3(0.3, -0.2, 0.4), .snr = snr};
        s.seed = static_cast<std::uint64_t>(seed);
        const Image<float> image = gaussian_smooth(make_phantom(s).image, 1.0);
        const Forms forms{gradient_images(image), flux_antiderivative(image)};
        RandomEngine random(s.seed);
        Parameters parameters = sphere;
        for (std::size_t i = 0; i < parameters.size(); ++i) {
          if (i % 6 >= 3) continue;
          const auto axis = static_cast<Eigen::Index>(i % 6);
          parameters[i] = s.center[axis] + (radius + 0.5) * sphere[i] + random.uniform(-0.4, 0.4);
        }
        for (const bool preintegrated : {false, true}) {
          const auto [e, z] = squares(gradient_of(forms, preintegrated, model, parameters, level),
                                      gradient_of(forms, preintegrated, model, parameters, dense));
          error[preintegrated ? 1 : 0] += e;
          size[preintegrated ? 1 : 0] += z;
        }
      }
      const double spacing = std::sqrt(12.566370614359172 * radius * radius / model.layout(level).sample_count());
      fmt::print("| {} | {:.2f} | {:.4f} | {:.4f} |\n", snr > 1e3 ? "no noise" : fmt::format("{}", snr), spacing,
                 std::sqrt(error[0] / size[0]), std::sqrt(error[1] / size[1]));
    }
  }
}

}  // namespace pellicle::bench
