#pragma once
/// The step of a surface that is linear in its control points (spline, Catmull-Clark, slime), in closed form.
///
/// With x = W c every residual energy is quadratic in c: half of |C W c - d|^2 for the rows of this step, half of
/// |L W c - t|^2 for the operators of the stage. Operators treat the three coordinates in the same way, so their part
/// of the normal matrix, K = (L W)^T (L W), is a scalar matrix over the blocks, made once a stage; rows add 3 x 3
/// blocks (v v^T). Targets t of operators (the motion's: dynamics.h) may change from step to step.

#include <Eigen/SparseCore>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "pellicle/solve/objective.h"

namespace pellicle {

class LinearSystem {
 public:
  /// \param layout of a linear model (it has stencils); `blocks` parameter blocks. Layout and operators must outlive
  /// this.
  LinearSystem(const SampleLayout& layout, std::size_t blocks, const std::vector<GroupedOperator>& operators);
  LinearSystem(LinearSystem&&) = delete;
  ~LinearSystem();
  /// Moves `parameters` to the minimum of half the squared residuals. Returns false, and leaves them alone, when
  /// numbers are not finite, the matrix cannot be factorised, or a row joins samples that share neither patch nor
  /// facet.
  bool minimise(const std::vector<NamedRows>& rows, Parameters& parameters);

 private:
  using Matrix = Eigen::SparseMatrix<double>;
  bool add_operators(const Parameters& parameters, Eigen::VectorXd& gradient);
  bool add_row(const ScalarRows& rows, std::size_t row, const Parameters& parameters, Eigen::VectorXd& gradient);
  std::optional<Eigen::VectorXd> solved_for(const Eigen::VectorXd& right);
  bool add_block(int row_block, int column_block, const Mat3& value);
  bool add_single_rows(const NamedRows& named, const Parameters& parameters, Eigen::VectorXd& gradient);

  const SampleLayout& layout_;
  Matrix operators_;                                              ///< K, blocks x blocks
  std::vector<std::pair<const GroupedOperator*, Matrix>> aimed_;  ///< operators with targets, and their L W
  std::vector<int> start_, at_;  ///< pattern: the row blocks at or below the diagonal of each column block, ascending
  Matrix normal_;                ///< lower half of the normal matrix, with the pattern's entries only
  struct Factor;
  std::unique_ptr<Factor> factor_;                ///< none before the first step
  std::vector<std::pair<int, Vec3>> derivative_;  ///< of one row by its blocks; room that is used again
  std::vector<double> local_;                     ///< symmetric 3 x 3 blocks of one patch; room that is used again
};

}  // namespace pellicle
