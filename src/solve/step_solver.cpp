#include "pellicle/solve/step_solver.h"

#include <utility>

namespace pellicle {

StepSolver::StepSolver(const SurfaceModel& model, const SampleLayout& layout, Solver solver, double trust_radius)
    : solver_(solver), trust_radius_(trust_radius) {
  problem_.model = &model;
  problem_.layout = &layout;
  problem_.operators = &operators_;
}

void StepSolver::set_operators(std::vector<GroupedOperator> operators) {
  linear_.reset();
  problem_.linear = nullptr;
  operators_ = std::move(operators);
  if (!problem_.layout->stencils || (solver_ != Solver::least_squares && solver_ != Solver::dynamic)) return;
  problem_.linear = &linear_.emplace(*problem_.layout, blocks_of(*problem_.model).size(), operators_);
}

void StepSolver::set_pulls(std::vector<NamedRows> rows, std::vector<ScalarEnergy> scalars) {
  problem_.rows = std::move(rows);
  problem_.scalars = std::move(scalars);
}

StepOutcome StepSolver::step(int most_iterations, int most_gradient_iterations, Parameters& parameters) {
  const bool gradient = solver_ == Solver::gradient || !problem_.scalars.empty();
  return solve_step(problem_, solver_, gradient ? most_gradient_iterations : most_iterations, trust_radius_,
                    parameters);
}

}  // namespace pellicle
