/// Cost of one refined vertex of the normal-subdivision model: value, adjoint, forward derivative, and the forward
/// derivative by dual numbers. One thread; the argument is the level. The counter is the time a vertex.

#include <benchmark/benchmark.h>

#include "pellicle/base/parallel.h"
#include "pellicle/base/random.h"
#include "pellicle/surface/normal/normal_model.h"
#include "surface/jet_patch.h"

namespace {

using namespace pellicle;

/// A sphere with points and normals moved by 20 %: every branch of the rule is met.
struct Case {
  explicit Case(const benchmark::State& state, SubdivisionRule rule = SubdivisionRule::smooth)
      : model(NormalModel::start(StartSolid::icosahedron, rule)),
        parameters(model.reference()),
        layout(model.layout(static_cast<int>(state.range(0)))) {
    RandomEngine random(1);
    for (double& x : parameters) x += random.uniform(-0.2, 0.2);
    for (std::size_t i = 3; i < parameters.size(); i += 6) {
      Eigen::Map<Vec3> normal(&parameters[i]);
      normal.normalize();
    }
  }
  int refined() const { return layout.sample_count() - model.vertex_count(); }

  NormalModel model;
  Parameters parameters;
  SampleLayout layout;
  ThreadLimit one_thread{1};
};

void report(benchmark::State& state, int vertices) {
  state.counters["a_vertex"] =
      benchmark::Counter(vertices, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void value(benchmark::State& state, SubdivisionRule rule) {
  const Case c(state, rule);
  SurfaceSamples samples;
  for (auto _ : state) c.model.evaluate(c.parameters, c.layout, false, samples);
  report(state, c.refined());
}

void adjoint(benchmark::State& state, SubdivisionRule rule) {
  const Case c(state, rule);
  const std::vector<Vec3> dE_dx(c.layout.patch_of.size(), Vec3(1, 2, 3));
  std::vector<double> gradient(c.parameters.size());
  for (auto _ : state) c.model.pull_back(c.parameters, c.layout, dE_dx, gradient);
  report(state, c.refined());
}

void forward(benchmark::State& state, SubdivisionRule rule) {
  const Case c(state, rule);
  SurfaceSamples samples;
  for (auto _ : state) c.model.evaluate(c.parameters, c.layout, true, samples);
  report(state, c.refined());
}

void dual_numbers(benchmark::State& state, SubdivisionRule rule) {
  const Case c(state, rule);
  std::vector<oracle::JetVertex> vertices;
  for (auto _ : state) {
    for (const SamplePatch& patch : c.layout.patches) {
      oracle::refine_patch(*c.layout.refinement, rule, c.parameters, patch, vertices);
      benchmark::DoNotOptimize(vertices.data());
    }
  }
  report(state, c.layout.refinement->vertex_count() * static_cast<int>(c.layout.patches.size()));
}

void layout(benchmark::State& state) {
  const NormalModel model = NormalModel::start(StartSolid::icosahedron, SubdivisionRule::smooth);
  for (auto _ : state) benchmark::DoNotOptimize(model.layout(static_cast<int>(state.range(0))));
}

BENCHMARK_CAPTURE(value, smooth, SubdivisionRule::smooth)->DenseRange(2, 5);
BENCHMARK_CAPTURE(adjoint, smooth, SubdivisionRule::smooth)->DenseRange(2, 5);
BENCHMARK_CAPTURE(forward, smooth, SubdivisionRule::smooth)->DenseRange(2, 5);
BENCHMARK_CAPTURE(dual_numbers, smooth, SubdivisionRule::smooth)->DenseRange(2, 5);
BENCHMARK_CAPTURE(value, published, SubdivisionRule::published)->Arg(4);
BENCHMARK_CAPTURE(adjoint, published, SubdivisionRule::published)->Arg(4);
BENCHMARK_CAPTURE(forward, published, SubdivisionRule::published)->Arg(4);
BENCHMARK(layout)->DenseRange(3, 5);

}  // namespace

BENCHMARK_MAIN();
