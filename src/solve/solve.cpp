// The two ways to minimise a step's problem with Ceres. See objective.h.

#include <ceres/ceres.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pellicle/energies/geometry.h"
#include "pellicle/solve/linear_system.h"
#include "pellicle/solve/objective.h"

namespace pellicle {

namespace {

/// Evaluates the samples before Ceres asks any block for residuals: once per point, for all blocks.
class SharedSamples final : public ceres::EvaluationCallback {
 public:
  SharedSamples(const StepProblem& problem, const Parameters& parameters)
      : problem_(problem), parameters_(parameters) {}
  void PrepareForEvaluation(bool evaluate_jacobians, bool new_point) override {
    if (!new_point && !(evaluate_jacobians && !has_jacobian_)) return;
    evaluate(*problem_.model, parameters_, *problem_.layout, evaluate_jacobians, samples_);
    has_jacobian_ = evaluate_jacobians;
  }
  const SurfaceSamples& samples() const { return samples_; }

 private:
  const StepProblem& problem_;
  const Parameters& parameters_;
  SurfaceSamples samples_;
  bool has_jacobian_ = false;
};

/// Rows of one group; `Residuals` is 1 for scalar rows, 3 for vector rows.
class RowGroupCost final : public ceres::CostFunction {
 public:
  RowGroupCost(const RowGroup& group, const SampleLayout& layout, const SharedSamples& shared, const ScalarRows* scalar,
               const VectorRows* vector, double root_weight)
      : group_(group), layout_(layout), shared_(shared), scalar_(scalar), vector_(vector), root_weight_(root_weight) {
    set_num_residuals(static_cast<int>(group.rows.size()) * (scalar != nullptr ? 1 : 3));
    mutable_parameter_block_sizes()->assign(group.blocks.size(), 3);
  }

  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
    const std::vector<Vec3>& x = shared_.samples().x;
    for (std::size_t r = 0; r < group_.rows.size(); ++r) {
      const auto row = static_cast<std::size_t>(group_.rows[r]);
      if (scalar_ != nullptr) {
        residuals[r] = scalar_->residual(row, x);
        if (!std::isfinite(residuals[r])) return false;
      } else {
        const Vec3 value = root_weight_ * vector_->residual(row, x);
        for (std::size_t c = 0; c < 3; ++c) residuals[3 * r + c] = value[static_cast<int>(c)];
        if (!value.allFinite()) return false;
      }
    }
    if (jacobians != nullptr) fill(jacobians);
    return true;
  }

 private:
  // Each block's Jacobian is row-major, residuals x 3.
  void fill(double** jacobians) const {
    for (std::size_t b = 0; b < group_.blocks.size(); ++b) {
      if (jacobians[b] != nullptr) std::fill_n(jacobians[b], 3 * static_cast<std::size_t>(num_residuals()), 0.0);
    }
    for (std::size_t r = 0; r < group_.rows.size(); ++r) {
      const auto row = static_cast<std::size_t>(group_.rows[r]);
      const auto& start = scalar_ != nullptr ? scalar_->start : vector_->start;
      const auto& sample = scalar_ != nullptr ? scalar_->sample : vector_->sample;
      for (auto k = static_cast<std::size_t>(start[row]); k < static_cast<std::size_t>(start[row + 1]); ++k) {
        add_sample(sample[k], r, k, jacobians);
      }
    }
  }

  void add_sample(int sample, std::size_t r, std::size_t k, double** jacobians) const {
    const int patch_id = layout_.patch_of[static_cast<std::size_t>(sample)];
    const SamplePatch& patch = layout_.patches[static_cast<std::size_t>(patch_id)];
    const auto where = std::lower_bound(group_.patches.begin(), group_.patches.end(), patch_id);
    const std::vector<int>& slots = group_.slots[static_cast<std::size_t>(where - group_.patches.begin())];
    const auto columns = static_cast<std::size_t>(patch.columns());
    const double* jacobian = shared_.samples().jacobian.data() + patch.jacobian_offset +
                             static_cast<std::size_t>(sample - patch.first_sample) * 3 * columns;
    for (std::size_t b = 0; b < slots.size(); ++b) {
      double* out = jacobians[slots[b]];
      if (out == nullptr) continue;
      if (scalar_ != nullptr) {
        const Vec3& c = scalar_->coefficient[k];
        for (std::size_t j = 0; j < 3; ++j) {
          out[3 * r + j] += c[0] * jacobian[3 * b + j] + c[1] * jacobian[columns + 3 * b + j] +
                            c[2] * jacobian[2 * columns + 3 * b + j];
        }
      } else {
        const double c = root_weight_ * vector_->coefficient[k];
        for (std::size_t i = 0; i < 3; ++i) {
          for (std::size_t j = 0; j < 3; ++j) out[9 * r + 3 * i + j] += c * jacobian[i * columns + 3 * b + j];
        }
      }
    }
  }

  const RowGroup& group_;
  const SampleLayout& layout_;
  const SharedSamples& shared_;
  const ScalarRows* scalar_;
  const VectorRows* vector_;
  double root_weight_;
};

/// Targets are drawn anew after each step: two accepted iterations are as good as the full way to the minimum.
class StopAfterTwo final : public ceres::IterationCallback {
 public:
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (summary.iteration > 0 && summary.step_is_successful) ++accepted_;
    return accepted_ >= 2 ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

 private:
  int accepted_ = 0;
};

StepOutcome solve_least_squares(const StepProblem& step, int max_iterations, double& trust_radius,
                                Parameters& parameters) {
  SharedSamples shared(step, parameters);
  ceres::Problem::Options problem_options;
  problem_options.evaluation_callback = &shared;
  problem_options.disable_all_safety_checks = true;
  ceres::Problem problem(problem_options);
  const std::vector<BlockKind> kinds = blocks_of(*step.model);
  for (std::size_t b = 0; b < kinds.size(); ++b) {
    ceres::Manifold* manifold = kinds[b] == BlockKind::unit_normal ? new ceres::SphereManifold<3>() : nullptr;
    problem.AddParameterBlock(parameters.data() + 3 * b, 3, manifold);
  }
  std::vector<std::vector<RowGroup>> groups;
  groups.reserve(step.rows.size() + step.operators->size());
  const auto add = [&](const RowGroup& group, const ScalarRows* scalar, const VectorRows* vector, double root_weight) {
    std::vector<double*> pointers;
    for (const int block : group.blocks) pointers.push_back(parameters.data() + 3 * static_cast<std::size_t>(block));
    problem.AddResidualBlock(new RowGroupCost(group, *step.layout, shared, scalar, vector, root_weight), nullptr,
                             pointers);
  };
  for (const auto& named : step.rows) {
    groups.push_back(group_rows(*step.layout, named.rows.start, named.rows.sample));
    for (const auto& group : groups.back()) add(group, &named.rows, nullptr, 1.0);
  }
  for (const auto& op : *step.operators) {
    if (op.groups.empty()) groups.push_back(group_rows(*step.layout, op.rows.start, op.rows.sample));
    for (const auto& group : op.groups.empty() ? groups.back() : op.groups)
      add(group, nullptr, &op.rows, op.root_weight);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.num_threads = 1;
  options.max_num_iterations = max_iterations;
  options.function_tolerance = 1e-6;
  options.initial_trust_region_radius = std::clamp(trust_radius, 1e-2, 1e4);
  StopAfterTwo stop;
  options.callbacks.push_back(&stop);
  options.logging_type = ceres::SILENT;
  // CHOLMOD's own threads cost more than they save at this size, and add in scheduling order.
  omp_set_num_threads(1);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.iterations.empty()) trust_radius = summary.iterations.back().trust_region_radius;
  return {static_cast<int>(summary.iterations.size()) - 1, summary.IsSolutionUsable(),
          summary.num_successful_steps > 1 || summary.termination_type == ceres::CONVERGENCE, summary.message};
}

/// Points in R^3 and unit normals on S^2, one after another.
class BlocksManifold final : public ceres::Manifold {
 public:
  explicit BlocksManifold(std::vector<BlockKind> kinds) : kinds_(std::move(kinds)) {
    for (const BlockKind kind : kinds_) tangent_ += kind == BlockKind::unit_normal ? 2 : 3;
  }
  int AmbientSize() const override { return 3 * static_cast<int>(kinds_.size()); }
  int TangentSize() const override { return tangent_; }
  bool Plus(const double* x, const double* delta, double* out) const override {
    for (const BlockKind kind : kinds_) {
      if (kind == BlockKind::unit_normal) {
        if (!sphere_.Plus(x, delta, out)) return false;
        delta += 2;
      } else {
        for (int c = 0; c < 3; ++c) out[c] = x[c] + delta[c];
        delta += 3;
      }
      x += 3;
      out += 3;
    }
    return true;
  }
  bool PlusJacobian(const double* x, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> out(jacobian, AmbientSize(),
                                                                                           tangent_);
    out.setZero();
    int column = 0;
    for (int b = 0; b < static_cast<int>(kinds_.size()); ++b) {
      if (kinds_[static_cast<std::size_t>(b)] == BlockKind::unit_normal) {
        Eigen::Matrix<double, 3, 2, Eigen::RowMajor> block;
        if (!sphere_.PlusJacobian(x + 3 * b, block.data())) return false;
        out.block<3, 2>(3 * b, column) = block;
        column += 2;
      } else {
        out.block<3, 3>(3 * b, column).setIdentity();
        column += 3;
      }
    }
    return true;
  }
  // The product that L-BFGS asks for, without the dense matrix.
  bool RightMultiplyByPlusJacobian(const double* x, int rows, const double* ambient, double* tangent) const override {
    for (int r = 0; r < rows; ++r) {
      const double* in = ambient + static_cast<std::ptrdiff_t>(r) * AmbientSize();
      double* out = tangent + static_cast<std::ptrdiff_t>(r) * tangent_;
      for (std::size_t b = 0; b < kinds_.size(); ++b, in += 3) {
        if (kinds_[b] == BlockKind::unit_normal) {
          Eigen::Matrix<double, 3, 2, Eigen::RowMajor> block;
          if (!sphere_.PlusJacobian(x + 3 * b, block.data())) return false;
          Eigen::Map<Eigen::RowVector2d>(out, 2) = Eigen::Map<const Eigen::RowVector3d>(in) * block;
          out += 2;
        } else {
          out = std::copy_n(in, 3, out);
        }
      }
    }
    return true;
  }
  bool Minus(const double* y, const double* x, double* delta) const override {
    for (const BlockKind kind : kinds_) {
      if (kind == BlockKind::unit_normal) {
        if (!sphere_.Minus(y, x, delta)) return false;
        delta += 2;
      } else {
        for (int c = 0; c < 3; ++c) delta[c] = y[c] - x[c];
        delta += 3;
      }
      x += 3;
      y += 3;
    }
    return true;
  }
  bool MinusJacobian(const double* x, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> out(jacobian, tangent_,
                                                                                           AmbientSize());
    out.setZero();
    int row = 0;
    for (int b = 0; b < static_cast<int>(kinds_.size()); ++b) {
      if (kinds_[static_cast<std::size_t>(b)] == BlockKind::unit_normal) {
        Eigen::Matrix<double, 2, 3, Eigen::RowMajor> block;
        if (!sphere_.MinusJacobian(x + 3 * b, block.data())) return false;
        out.block<2, 3>(row, 3 * b) = block;
        row += 2;
      } else {
        out.block<3, 3>(row, 3 * b).setIdentity();
        row += 3;
      }
    }
    return true;
  }

 private:
  std::vector<BlockKind> kinds_;
  int tangent_ = 0;
  ceres::SphereManifold<3> sphere_;
};

/// Sum of all energies as one function of the parameters; the gradient by the adjoint.
class SurfaceObjective final : public ceres::FirstOrderFunction {
 public:
  SurfaceObjective(const StepProblem& step, int parameters) : step_(step), size_(parameters) {}
  int NumParameters() const override { return size_; }
  bool Evaluate(const double* parameters, double* cost, double* gradient) const override {
    point_.assign(parameters, parameters + size_);
    evaluate(*step_.model, point_, *step_.layout, false, samples_);
    const std::vector<Vec3>& x = samples_.x;
    std::vector<Vec3> dE_dx(x.size(), Vec3::Zero());
    *cost = add_rows(x, dE_dx);
    if (!step_.scalars.empty()) {
      const std::vector<Vec3> area = area_vectors(*step_.layout, x);
      std::vector<Vec3> dE_da(x.size(), Vec3::Zero());
      for (const auto& scalar : step_.scalars) *cost += scalar.evaluate(x, area, dE_dx, dE_da);
      pull_back_area_vectors(*step_.layout, x, dE_da, dE_dx);
    }
    if (!std::isfinite(*cost)) return false;
    if (gradient != nullptr) {
      std::vector<double> out(static_cast<std::size_t>(size_), 0.0);
      pull_back(*step_.model, point_, *step_.layout, dE_dx, out);
      std::copy(out.begin(), out.end(), gradient);
    }
    return true;
  }

 private:
  double add_rows(const std::vector<Vec3>& x, std::vector<Vec3>& dE_dx) const {
    double cost = 0.0;
    for (const auto& named : step_.rows) {
      for (std::size_t r = 0; r < named.rows.size(); ++r) {
        const double residual = named.rows.residual(r, x);
        cost += 0.5 * residual * residual;
        for (auto k = static_cast<std::size_t>(named.rows.start[r]);
             k < static_cast<std::size_t>(named.rows.start[r + 1]); ++k) {
          dE_dx[static_cast<std::size_t>(named.rows.sample[k])] += residual * named.rows.coefficient[k];
        }
      }
    }
    for (const auto& op : *step_.operators) {
      for (std::size_t r = 0; r < op.rows.size(); ++r) {
        const Vec3 residual = op.root_weight * op.rows.residual(r, x);
        cost += 0.5 * residual.squaredNorm();
        for (auto k = static_cast<std::size_t>(op.rows.start[r]); k < static_cast<std::size_t>(op.rows.start[r + 1]);
             ++k) {
          dE_dx[static_cast<std::size_t>(op.rows.sample[k])] += op.root_weight * op.rows.coefficient[k] * residual;
        }
      }
    }
    return cost;
  }

  const StepProblem& step_;
  int size_;
  mutable Parameters point_;
  mutable SurfaceSamples samples_;
};

StepOutcome solve_gradient(const StepProblem& step, int max_iterations, Parameters& parameters) {
  ceres::GradientProblem problem(new SurfaceObjective(step, static_cast<int>(parameters.size())),
                                 new BlocksManifold(blocks_of(*step.model)));
  ceres::GradientProblemSolver::Options options;
  options.line_search_direction_type = ceres::LBFGS;
  options.max_num_iterations = max_iterations;
  options.function_tolerance = 1e-7;
  options.logging_type = ceres::SILENT;
  ceres::GradientProblemSolver::Summary summary;
  Parameters trial = parameters;
  ceres::Solve(options, problem, trial.data(), &summary);
  const bool usable = summary.IsSolutionUsable();
  if (usable) parameters = std::move(trial);
  return {static_cast<int>(summary.iterations.size()) - 1, usable, true, summary.message};
}

}  // namespace

StepOutcome solve_step(const StepProblem& problem, Solver solver, int max_iterations, double& trust_radius,
                       Parameters& parameters) {
  if (solver == Solver::gradient || !problem.scalars.empty())
    return solve_gradient(problem, max_iterations, parameters);
  const bool closed_form = solver == Solver::least_squares || solver == Solver::dynamic;
  if (closed_form && problem.linear != nullptr && problem.linear->minimise(problem.rows, parameters)) {
    return {1, true, true, "closed form"};
  }
  return solve_least_squares(problem, max_iterations, trust_radius, parameters);
}

}  // namespace pellicle
