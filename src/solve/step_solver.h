#pragma once
/// The steps of one surface, one after another: what stays from step to step, for fits to images and to points alike.

#include <optional>
#include <string>
#include <vector>

#include "pellicle/solve/linear_system.h"
#include "pellicle/solve/objective.h"

namespace pellicle {

/// Keeps the constant operators, the closed form that is made of them, and the trust radius.
class StepSolver {
 public:
  /// \param model, layout must outlive this.
  /// \param trust_radius of Levenberg-Marquardt in the first step.
  StepSolver(const SurfaceModel& model, const SampleLayout& layout, Solver solver, double trust_radius);
  StepSolver(StepSolver&&) = delete;
  ~StepSolver() = default;

  /// From now on these; the closed form is made anew where the model and the solver have one.
  void set_operators(std::vector<GroupedOperator> operators);
  void set_trust_radius(double radius) { trust_radius_ = radius; }
  const std::vector<GroupedOperator>& operators() const { return operators_; }
  /// The last operator, whose targets may change from step to step (dynamics.h).
  GroupedOperator& last_operator() { return operators_.back(); }
  bool has_closed_form() const { return linear_.has_value(); }

  /// What the next step asks for.
  void set_pulls(std::vector<NamedRows> rows, std::vector<ScalarEnergy> scalars = {});
  /// Moves `parameters`. \param most_iterations of Levenberg-Marquardt; L-BFGS takes `most_gradient_iterations`.
  StepOutcome step(int most_iterations, int most_gradient_iterations, Parameters& parameters);
  /// The energies by name at given samples, weighted.
  std::map<std::string, double> energies(const std::vector<Vec3>& x) const { return energies_at(problem_, x); }

 private:
  Solver solver_;
  double trust_radius_;
  std::vector<GroupedOperator> operators_;
  std::optional<LinearSystem> linear_;
  StepProblem problem_;
};

}  // namespace pellicle
