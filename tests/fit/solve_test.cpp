// One step's problem: both solvers find the same minimum, on any number of threads.

#include <gmock/gmock.h>

#include <cmath>
#include <optional>

#include "pellicle/base/parallel.h"
#include "pellicle/base/random.h"
#include "pellicle/energies/bending.h"
#include "pellicle/energies/geometry.h"
#include "pellicle/energies/inflation.h"
#include "pellicle/energies/spacing.h"
#include "pellicle/energies/tension.h"
#include "pellicle/solve/objective.h"

namespace pellicle {
namespace {

/// A sphere of 10 mm that is asked to become a smooth lump about 1 mm away; 10 control points.
struct Step {
  Surface surface = start();
  SampleLayout layout = layout_of(surface.model, 3);
  std::vector<GroupedOperator> operators;
  StepProblem problem;

  explicit Step(bool with_scalar) {
    const SampledSurface samples(layout, surface);
    const std::vector<double>& area = samples.area();
    NormalTargets targets{std::vector<double>(area.size()), std::vector<double>(area.size(), 1.0)};
    for (std::size_t i = 0; i < area.size(); ++i) {
      const Vec3& u = layout.reference[i];
      targets.offset[i] = 0.6 + 0.5 * u.x() * u.y() - 0.4 * u.z() * u.z();
      targets.weight[i] = 1.0 + 0.5 * u.x();
    }
    operators.push_back(grouped_operator("bending", 1e-3, bending_rows(layout), layout));
    operators.push_back(grouped_operator("tension", 1e-3, tension_rows(layout), layout));
    problem.model = &surface.model;
    problem.layout = &layout;
    problem.operators = &operators;
    problem.rows.push_back({"edge", offset_rows(samples, targets, 1.0)});
    problem.rows.push_back({"spacing", spacing_rows(samples, 0.1)});
    if (with_scalar) {
      const double volume = samples.volume(), total = samples.total_area();
      const SampleLayout* of = &layout;
      problem.scalars.push_back({"inflation", [=](const auto& x, const auto& a, auto& dx, auto&) {
                                   return inflation(facet_volume(*of, x), volume, total, 1.0, 0.5, a, dx);
                                 }});
    }
  }
  Step(const Step&) = delete;
  static Surface start() {
    const NormalModel model = NormalModel::start(StartSolid::tetrahedron, SubdivisionRule::smooth);
    return refine(Surface{model, affine_image(model, Vec3(3, -2, 5), 10.0 * Mat3::Identity())});
  }

  double energy(const Parameters& parameters) const {
    SurfaceSamples samples;
    evaluate(surface.model, parameters, layout, false, samples);
    double total = 0.0;
    for (const auto& [name, value] : energies_at(problem, samples.x)) total += value;
    return total;
  }
  Parameters solve(Solver solver, int calls) const {
    Parameters parameters = surface.parameters;
    double trust_radius = 1e3;
    for (int i = 0; i < calls; ++i) {
      EXPECT_TRUE(solve_step(problem, solver, 200, trust_radius, parameters).usable);
    }
    return parameters;
  }
};

TEST(SolveStep, least_squares_and_gradient_find_the_same_minimum) {
  const Step step(false);
  const double start = step.energy(step.surface.parameters);
  const Parameters a = step.solve(Solver::least_squares, 30), b = step.solve(Solver::gradient, 10);
  const double by_squares = step.energy(a), by_gradient = step.energy(b);
  EXPECT_LT(by_squares, 0.5 * start);
  EXPECT_NEAR(by_gradient / by_squares, 1.0, 1e-3);
  SurfaceSamples x, y;
  evaluate(step.surface.model, a, step.layout, false, x);
  evaluate(step.surface.model, b, step.layout, false, y);
  double worst = 0.0;
  for (std::size_t i = 0; i < x.x.size(); ++i) worst = std::max(worst, (x.x[i] - y.x[i]).norm());
  EXPECT_LE(worst, 0.02);
}

TEST(SolveStep, what_it_finds_is_a_minimum) {
  const Step step(false);
  const Parameters best = step.solve(Solver::least_squares, 30);
  const double least = step.energy(best);
  RandomEngine random(5);
  for (int trial = 0; trial < 200; ++trial) {
    Parameters other = best;
    for (std::size_t v = 0; v < other.size(); v += 6) {
      Vec3 normal(&other[v + 3]);
      for (std::size_t c = 0; c < 3; ++c) other[v + c] += 0.03 * random.normal();
      normal = (normal + 0.003 * Vec3(random.normal(), random.normal(), random.normal())).normalized();
      std::copy_n(normal.data(), 3, &other[v + 3]);
    }
    EXPECT_GE(step.energy(other), least);
  }
}

TEST(SolveStep, never_raises_the_energy_and_keeps_normals_unit) {
  for (const bool scalar : {false, true}) {
    for (const Solver solver : {Solver::least_squares, Solver::gradient}) {
      const Step step(scalar);
      Parameters parameters = step.surface.parameters;
      double trust_radius = 1e3, before = step.energy(parameters);
      for (int i = 0; i < 4; ++i) {
        const StepOutcome outcome = solve_step(step.problem, solver, 5, trust_radius, parameters);
        EXPECT_TRUE(outcome.usable) << outcome.message;
        EXPECT_LE(outcome.iterations, 5);
        const double after = step.energy(parameters);
        EXPECT_LE(after, before + 1e-12);
        before = after;
      }
      for (std::size_t v = 0; v < parameters.size(); v += 6) {
        EXPECT_NEAR(Vec3(&parameters[v + 3]).norm(), 1.0, 1e-9);
      }
    }
  }
}

TEST(SolveStep, same_bytes_on_one_thread_and_on_two) {
  for (const bool scalar : {false, true}) {
    for (const Solver solver : {Solver::least_squares, Solver::gradient}) {
      const Step step(scalar);
      Parameters one, two;
      {
        const ThreadLimit limit(1);
        one = step.solve(solver, 3);
      }
      {
        const ThreadLimit limit(2);
        two = step.solve(solver, 3);
      }
      EXPECT_EQ(one, two);
    }
  }
}

TEST(SolveStep, numbers_that_are_not_finite_are_reported_and_nothing_moves) {
  for (const Solver solver : {Solver::least_squares, Solver::gradient}) {
    Step step(false);
    step.problem.rows[0].rows.target[0] = std::nan("");
    Parameters parameters = step.surface.parameters;
    double trust_radius = 1e3;
    EXPECT_FALSE(solve_step(step.problem, solver, 5, trust_radius, parameters).usable);
    EXPECT_EQ(parameters, step.surface.parameters);
  }
}

TEST(GroupRows, every_row_once_with_all_the_blocks_of_its_samples) {
  const Step step(false);
  const VectorRows& rows = step.operators[0].rows;
  std::vector<int> seen(rows.size(), 0);
  for (const RowGroup& group : step.operators[0].groups) {
    ASSERT_EQ(group.slots.size(), group.patches.size());
    for (std::size_t p = 0; p < group.patches.size(); ++p) {
      const auto& blocks = step.layout.patches[static_cast<std::size_t>(group.patches[p])].blocks;
      ASSERT_EQ(group.slots[p].size(), blocks.size());
      for (std::size_t b = 0; b < blocks.size(); ++b) {
        EXPECT_EQ(group.blocks.at(static_cast<std::size_t>(group.slots[p][b])), blocks[b]);
      }
    }
    for (const int row : group.rows) {
      ++seen[static_cast<std::size_t>(row)];
      for (int k = rows.start[static_cast<std::size_t>(row)]; k < rows.start[static_cast<std::size_t>(row) + 1]; ++k) {
        const int sample = rows.sample[static_cast<std::size_t>(k)];
        EXPECT_THAT(group.patches, testing::Contains(step.layout.patch_of[static_cast<std::size_t>(sample)]));
      }
    }
  }
  for (const int times : seen) EXPECT_EQ(times, 1);
}

}  // namespace
}  // namespace pellicle
