/// A correction of a finished fit: one expert point moves, and the last stage runs again in the session that is held.
/// Milliseconds per correction, 256^3 phantom. Arguments: model (0 normal, 1 catmull-clark), refinements.

#include <benchmark/benchmark.h>

#include "pellicle/fit/refinement.h"
#include "pellicle/fit/surface_fit.h"
#include "pellicle/mesh/distance.h"
#include "pellicle/synthetic/phantom.h"

namespace pellicle {
namespace {

const Phantom& phantom() {
  static const Phantom made = [] {
    PhantomSettings settings;
    settings.shape = "blob";
    settings.size = {256, 256, 256};
    settings.radius = {70.0};
    return make_phantom(settings);
  }();
  return made;
}

/// A finished fit with expert points on the true surface.
struct Session {
  Session(ModelKind kind, int detail)
      : points{.points = sample_surface(phantom().truth_surface, 20)},
        fit(phantom().image, points, options(kind, detail)),
        attempt(fit.propose(SeedSphere{phantom().natural_center, 50.0}).front()) {
    fit.try_out(attempt);
    refine_by_prediction(fit, attempt);
  }
  static FitOptions options(ModelKind kind, int detail) {
    FitOptions options;
    options.model.kind = kind;
    options.detail = detail;
    options.polarity = Polarity::bright;
    options.boundary = Boundary::step;
    return options;
  }
  ExpertPoints points;
  SurfaceFit fit;
  Attempt attempt;
};

void move_one_point(benchmark::State& state) {
  Session session(state.range(0) == 0 ? ModelKind::normal : ModelKind::catmull_clark, static_cast<int>(state.range(1)));
  StageRequest again = session.attempt.last;
  again.continued = true;
  double shift = 1.0;
  for (auto _ : state) {
    session.points.points.front().x() += shift;
    shift = -shift;
    session.fit.set_points(session.points);
    Candidate candidate = session.attempt.now;
    const StageOutcome outcome = session.fit.advance(candidate, again);
    state.counters["steps"] = outcome.summary.steps;
    state.counters["solver_iterations"] = outcome.summary.solver_iterations;
    state.counters["samples"] = outcome.summary.samples;
  }
  state.counters["control_points"] = control_point_count(session.attempt.now.surface.model);
}

BENCHMARK(move_one_point)->Args({0, 2})->Args({0, 3})->Args({1, 2})->Args({1, 3})->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pellicle

BENCHMARK_MAIN();
