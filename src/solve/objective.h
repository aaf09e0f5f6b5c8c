#pragma once
/// One step's problem: what the energies ask for, chained to the parameters, solved by Ceres. The only caller of
/// ceres::Solve.
///
/// Residual energies arrive as rows that are linear in the sample positions (energies/rows.h). Rows are grouped by the
/// patches that their samples belong to; each group is one Ceres residual block over the union of those patches'
/// parameter blocks. The samples and their Jacobians are evaluated once per solver iteration, in parallel, and
/// shared by all blocks; Ceres itself runs on one thread, so results do not depend on the number of threads.

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "pellicle/energies/rows.h"
#include "pellicle/energies/term.h"
#include "pellicle/solve/solver.h"
#include "pellicle/surface/surface.h"

namespace pellicle {

/// Rows of samples that belong to the same set of patches.
struct RowGroup {
  std::vector<int> blocks;              ///< union of the patches' parameter blocks, ascending
  std::vector<int> patches;             ///< ascending
  std::vector<std::vector<int>> slots;  ///< per patch, per block of the patch: its place in `blocks`
  std::vector<int> rows;
};
/// \param start, sample compressed rows as in ScalarRows and VectorRows.
std::vector<RowGroup> group_rows(const SampleLayout& layout, const std::vector<int>& start,
                                 const std::vector<int>& sample);

/// Constant operators (bending, tension; motion, whose targets change): built once a stage.
struct GroupedOperator {
  std::string name;
  double root_weight = 1.0;  ///< square root of the energy's weight
  VectorRows rows;
  std::vector<RowGroup> groups;                     ///< empty where the closed form makes them superfluous
  double energy(const std::vector<Vec3>& x) const;  ///< weighted, mm^2
};
GroupedOperator grouped_operator(std::string name, double weight, VectorRows rows, const SampleLayout& layout);

/// Rows of this step (offsets, spacing), already weighted.
struct NamedRows {
  std::string name;
  ScalarRows rows;
  double energy(const std::vector<Vec3>& x) const;
};

/// A scalar energy of samples and area vectors, weighted.
struct ScalarEnergy {
  std::string name;
  ScalarValue evaluate;
};

class LinearSystem;

struct StepProblem {
  const SurfaceModel* model = nullptr;
  const SampleLayout* layout = nullptr;
  const std::vector<GroupedOperator>* operators = nullptr;
  std::vector<NamedRows> rows;
  std::vector<ScalarEnergy> scalars;
  LinearSystem* linear = nullptr;  ///< of a model that is linear in its control points: the closed form
};

struct StepOutcome {
  int iterations = 0;
  bool usable = false;  ///< false: the solver met values that are not finite; parameters are unchanged
  bool moved = true;    ///< false: no step was accepted although the gradient is not zero
  std::string message;
};

/// Moves `parameters`. Residual energies alone: in closed form where problem.linear is set and `solver` leaves the
/// choice, else Levenberg-Marquardt. With scalar energies, or when `solver` says so: ceres::GradientProblem (L-BFGS) on
/// their sum plus half the squared residuals.
/// \param trust_radius of Levenberg-Marquardt: where this step starts, and on return where it ended, for the next.
StepOutcome solve_step(const StepProblem& problem, Solver solver, int max_iterations, double& trust_radius,
                       Parameters& parameters);

/// The energies by name at given samples, weighted.
std::map<std::string, double> energies_at(const StepProblem& problem, const std::vector<Vec3>& x);

}  // namespace pellicle
