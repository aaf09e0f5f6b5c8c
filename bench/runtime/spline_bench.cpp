/// Volume and its gradient of spline spheres of M x M control points, by quadrature and as a trilinear form. One
/// thread.

#include <benchmark/benchmark.h>

#include "pellicle/base/random.h"
#include "pellicle/surface/spline/spline_volume.h"

namespace pellicle {
namespace {

struct Case {
  explicit Case(const benchmark::State& state)
      : model({.m1 = static_cast<int>(state.range(0)), .m2 = static_cast<int>(state.range(0))}),
        parameters(model.reference()),
        gradient(parameters.size(), 0.0) {
    RandomEngine random(1);
    for (double& x : parameters) x += random.uniform(-0.1, 0.1);
  }
  SplineModel model;
  Parameters parameters;
  std::vector<double> gradient;
};

void quadrature(benchmark::State& state) {
  Case c(state);
  const SplineVolume volume(c.model);
  for (auto _ : state) benchmark::DoNotOptimize(volume.value_and_gradient(c.parameters, c.gradient));
}

void trilinear_form(benchmark::State& state) {
  Case c(state);
  const SplineVolumeForm volume(c.model);
  for (auto _ : state) benchmark::DoNotOptimize(volume.value_and_gradient(c.parameters, c.gradient));
}

BENCHMARK(quadrature)->Arg(8)->Arg(12)->Arg(20)->Unit(benchmark::kMicrosecond);
BENCHMARK(trilinear_form)->Arg(8)->Arg(12)->Arg(20)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace pellicle
