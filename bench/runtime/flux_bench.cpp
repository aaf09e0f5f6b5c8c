/// Cost of the flux and its derivatives: through the surface (three components of the gradient image) against
/// pre-integrated (one antiderivative). One thread; arguments are the level of the icosahedron's samples and the edge
/// of the image in voxels. Counters: time a sample; for the preparation, time a voxel.

#include <benchmark/benchmark.h>

#include <array>

#include "pellicle/base/parallel.h"
#include "pellicle/base/random.h"
#include "pellicle/energies/flux.h"
#include "pellicle/energies/geometry.h"
#include "pellicle/energies/region.h"
#include "pellicle/surface/normal/normal_model.h"

namespace {

using namespace pellicle;

/// A smooth random image, and a sphere that fills three quarters of it.
struct Case {
  explicit Case(const benchmark::State& state)
      : layout(NormalModel::start(StartSolid::icosahedron, SubdivisionRule::smooth)
                   .layout(static_cast<int>(state.range(0)))) {
    const auto n = static_cast<int>(state.range(1));
    image = Image<float>(ImageGrid{{n, n, n}, Vec3(1, 1, 1), Vec3::Zero(), Mat3::Identity()});
    RandomEngine random(1);
    for (float& v : image.voxels) v = static_cast<float>(random.normal());
    const Vec3 centre = Vec3::Constant(0.5 * (n - 1));
    for (const Vec3& p : layout.reference) x.push_back(centre + 0.37 * n * p.normalized());
    area = area_vectors(layout, x);
    dx.assign(x.size(), Vec3::Zero());
    da.assign(x.size(), Vec3::Zero());
  }
  SampleLayout layout;
  Image<float> image;
  std::vector<Vec3> x, area, dx, da;
  ThreadLimit one_thread{1};
};

void report(benchmark::State& state, std::size_t count) {
  state.counters["each"] = benchmark::Counter(
      static_cast<double>(count), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void through_the_surface(benchmark::State& state) {
  Case c(state);
  const auto images = gradient_images(c.image);
  const std::array<CubicField, 3> fields{CubicField(images[0]), CubicField(images[1]), CubicField(images[2])};
  for (auto _ : state) benchmark::DoNotOptimize(flux(fields, 1.0, c.x, c.area, c.dx, c.da));
  report(state, c.x.size());
}

void preintegrated(benchmark::State& state) {
  Case c(state);
  const Image<float> g = flux_antiderivative(c.image);
  const CubicField field(g);
  for (auto _ : state) {
    benchmark::DoNotOptimize(region_integral(field, Vec3::UnitX(), 1.0, c.x, c.area, c.dx, c.da));
  }
  report(state, c.x.size());
}

void prepare_the_surface_form(benchmark::State& state) {
  const Case c(state);
  for (auto _ : state) benchmark::DoNotOptimize(gradient_images(c.image));
  report(state, c.image.voxels.size());
}

void prepare_the_preintegrated_form(benchmark::State& state) {
  const Case c(state);
  for (auto _ : state) benchmark::DoNotOptimize(flux_antiderivative(c.image));
  report(state, c.image.voxels.size());
}

BENCHMARK(through_the_surface)->ArgsProduct({{3, 4, 5}, {64, 192}});
BENCHMARK(preintegrated)->ArgsProduct({{3, 4, 5}, {64, 192}});
BENCHMARK(prepare_the_surface_form)->ArgsProduct({{3}, {64, 192}});
BENCHMARK(prepare_the_preintegrated_form)->ArgsProduct({{3}, {64, 192}});

}  // namespace

BENCHMARK_MAIN();
