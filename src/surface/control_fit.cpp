#include "pellicle/surface/internal/control_fit.h"

#include <Eigen/Sparse>

#include "pellicle/base/errors.h"
#include "pellicle/surface/linear_stencils.h"

namespace pellicle {
namespace {

/// Keeps the normal equations regular, relative to their mean diagonal; far below what moves a sample visibly.
constexpr double kHold = 1e-10;

}  // namespace

struct ControlFit::Factor {
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> ldlt;
  double hold = 0.0;
};

ControlFit::ControlFit(const SampleLayout& layout, int block_count)
    : layout_(layout), factor_(std::make_unique<Factor>()) {
  if (layout.stencils == nullptr) throw BadData("control points (all): the surface model is not linear in them");
  std::vector<Eigen::Triplet<double>> entries;
  double trace = 0.0;
  for (const SamplePatch& patch : layout.patches) {
    const auto count = static_cast<Eigen::Index>(patch.blocks.size());
    const Eigen::Map<const Eigen::MatrixXd> weights(layout.stencils->x.data() + patch.jacobian_offset / 9, count,
                                                    patch.sample_count);
    const Eigen::MatrixXd gram = weights * weights.transpose();
    trace += gram.trace();
    for (Eigen::Index a = 0; a < count; ++a) {
      for (Eigen::Index b = 0; b < count; ++b) {
        entries.emplace_back(patch.blocks[static_cast<std::size_t>(a)], patch.blocks[static_cast<std::size_t>(b)],
                             gram(a, b));
      }
    }
  }
  factor_->hold = kHold * trace / block_count;
  for (int b = 0; b < block_count; ++b) entries.emplace_back(b, b, factor_->hold);
  Eigen::SparseMatrix<double> normal(block_count, block_count);
  normal.setFromTriplets(entries.begin(), entries.end());
  factor_->ldlt.compute(normal);
}

ControlFit::~ControlFit() = default;

Parameters ControlFit::solve(const std::vector<Vec3>& target, const Parameters& prior) const {
  std::vector<double> right(prior.size(), 0.0);
  pull_back_linear(layout_, target, right);
  using Columns = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
  const auto count = static_cast<Eigen::Index>(prior.size() / 3);
  const Eigen::Map<const Columns> before(prior.data(), count, 3), sum(right.data(), count, 3);
  const Columns points = factor_->ldlt.solve((sum + factor_->hold * before).eval());
  return {points.data(), points.data() + points.size()};
}

Parameters fit_unit_sphere(const SampleLayout& layout, const Parameters& start) {
  const ControlFit fit(layout, static_cast<int>(start.size() / 3));
  constexpr int kSteps = 10;  // samples slide to where the sphere is nearest; three or four are enough
  Parameters points = start;
  SurfaceSamples samples;
  for (int step = 0; step < kSteps; ++step) {
    evaluate_linear(points, layout, false, samples);
    for (Vec3& x : samples.x) x.normalize();
    points = fit.solve(samples.x, points);
  }
  return points;
}

}  // namespace pellicle
