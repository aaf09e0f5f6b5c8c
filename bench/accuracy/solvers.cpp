// The two ways to minimise, on the same cases: line search along normals with Levenberg-Marquardt, and scalar integrals
// with L-BFGS. Both stop after the region stages of 34 control points; the last row adds the flux of the gradient.

#include <fmt/format.h>

#include <cstdio>

#include "pellicle/energies/energy_kinds.h"
#include "pellicle/energies/profiles.h"
#include "pellicle/mesh/distance.h"
#include "pellicle/synthetic/phantom.h"
#include "sections.h"

namespace pellicle::bench {

namespace {

std::vector<Stage> stages_with(Solver solver, bool flux) {
  std::vector<Stage> stages;
  for (int detail = 1; detail <= 2; ++detail) {
    Stage stage{
        .name = fmt::format("region {}", detail),
        .detail = detail,
        .energies = {{energy::region, 1.0}, {energy::bending, detail == 1 ? 2e-3 : 2e-4}, {energy::spacing, 0.05}},
        .resolution = 0.0,
        .smoothing = 1.0,
        .reach = 5.0,
        .max_steps = 12,
        .tolerance = 0.02,
        .solver = solver};
    if (flux && detail == 2) {
      stage.energies.erase(energy::region);
      stage.energies[energy::flux] = 1.0;
      stage.solver = Solver::gradient;
    }
    stages.push_back(stage);
  }
  return stages;
}

}  // namespace

void solver_table() {
  fmt::print("\n## Two ways to minimise, 34 control points, SNR 5, four seeds a case\n\n");
  fmt::print(
      "| case | way | ASSD median (voxel) | worst | solver iterations | seconds (median) "
      "|\n|---|---|---|---|---|---|\n");
  struct Way {
    const char* name;
    Solver solver;
    bool flux;
  };
  for (const std::string shape : {"ellipsoid", "blob", "bean", "dumbbell"}) {
    PhantomSettings s;
    s.shape = shape;
    s.size = {104, 104, 104};
    const Phantom phantom = make_phantom(s);
    for (const Way& way : {Way{"line search, Levenberg-Marquardt", Solver::least_squares, false},
                           Way{"region integral, L-BFGS", Solver::gradient, false},
                           Way{"line search, then flux by L-BFGS", Solver::least_squares, true}}) {
      std::vector<double> assd, seconds, iterations;
      for (std::size_t k = 0; k < 4; ++k) {
        const SeedDraw& seed = phantom.seeds[k];
        FitOptions settings;
        settings.polarity = Polarity::bright;
        settings.boundary = Boundary::step;
        settings.similarity = false;
        settings.stages = stages_with(way.solver, way.flux);
        const double begin = seconds_now();
        const FitResult fit = fit_surface({phantom.image, {SeedSphere{seed.center, seed.radius}}}, settings);
        seconds.push_back(seconds_now() - begin);
        iterations.push_back(fit.summary.iterations());
        assd.push_back(surface_distances(measuring_mesh(fit.surface, 1.0), phantom.truth_surface, 1.0).assd);
      }
      fmt::print("| {} | {} | {:.3f} | {:.3f} | {:.0f} | {:.2f} |\n", shape, way.name, median_of(assd),
                 quantile_of(assd, 1.0), median_of(iterations), median_of(seconds));
      std::fflush(stdout);
    }
  }
}

}  // namespace pellicle::bench
