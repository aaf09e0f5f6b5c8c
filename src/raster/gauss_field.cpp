#include "pellicle/raster/internal/gauss_field.h"

#include <Eigen/Core>
#include <algorithm>
#include <numbers>

#include "pellicle/base/parallel.h"

namespace pellicle {

namespace {

using Column = Eigen::ArrayXf;
using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// K(x, y) to all points at once, three arrays one after the other; the kernel is smooth within `width`.
class GaussKernel {
 public:
  GaussKernel(const std::vector<Vec3>& points, double width)
      : count_(static_cast<Eigen::Index>(points.size())), y_(3 * count_) {
    for (const Vec3& x : points) middle_ += x / static_cast<double>(points.size());
    for (Eigen::Index j = 0; j < count_; ++j) {
      for (int a = 0; a < 3; ++a) {
        y_[a * count_ + j] = static_cast<float>(points[static_cast<std::size_t>(j)][a] - middle_[a]);
      }
    }
    least2_ = static_cast<float>(width * width);
  }

  /// `row` of size 3 n; `scale` of size n is room to work in.
  void at(const Vec3& x, Column& row, Column& scale) const {
    const Eigen::Vector3f from = (x - middle_).cast<float>();
    for (int a = 0; a < 3; ++a) row.segment(a * count_, count_) = y_.segment(a * count_, count_) - from[a];
    const auto d = [&](int a) { return row.segment(a * count_, count_); };
    scale = (d(0).square() + d(1).square() + d(2).square()).max(least2_);
    scale = 1.0F / (static_cast<float>(4.0 * std::numbers::pi) * scale * scale.sqrt());
    for (int a = 0; a < 3; ++a) row.segment(a * count_, count_) *= scale;
  }

  Eigen::Index count() const { return count_; }

 private:
  Eigen::Index count_;
  Column y_;
  Vec3 middle_ = Vec3::Zero();
  float least2_ = 0.0F;
};

template <class F>
void for_rows(std::size_t n, const F& body) {
  parallel_for(n, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(static_cast<Eigen::Index>(i));
  });
}

Eigen::VectorXf times(const Rows& A, const Eigen::VectorXf& x) {
  Eigen::VectorXf y(A.rows());
  for_rows(static_cast<std::size_t>(A.rows()), [&](Eigen::Index i) { y[i] = A.row(i).dot(x); });
  return y;
}

Eigen::VectorXf transpose_times(const Rows& A, const Eigen::VectorXf& x) {
  Eigen::VectorXf y(A.cols());
  parallel_for(static_cast<std::size_t>(A.cols()), 256, [&](std::size_t begin, std::size_t end) {
    const auto first = static_cast<Eigen::Index>(begin), count = static_cast<Eigen::Index>(end - begin);
    y.segment(first, count).noalias() = A.middleCols(first, count).transpose() * x;
  });
  return y;
}

// The shortest a with A a = `value` in every row, lightly regularised: a = A^T v, (A A^T + 0.05 D) v = value with D the
// diagonal of A A^T, by conjugate gradients preconditioned with D.
Eigen::VectorXf shortest_with(const Rows& A, float value) {
  constexpr float kRegular = 0.05F, kTolerance = 1e-3F;
  constexpr int kMostSteps = 200;
  const Eigen::VectorXf D = A.rowwise().squaredNorm();
  Eigen::VectorXf v = Eigen::VectorXf::Zero(A.rows());
  Eigen::VectorXf residual = Eigen::VectorXf::Constant(A.rows(), value), z = residual.cwiseQuotient(D), p = z;
  float rho = residual.dot(z);
  const float enough = kTolerance * residual.norm();
  for (int step = 0; step < kMostSteps && residual.norm() > enough; ++step) {
    const Eigen::VectorXf q = times(A, transpose_times(A, p)) + kRegular * D.cwiseProduct(p);
    const float alpha = rho / p.dot(q);
    v += alpha * p;
    residual -= alpha * q;
    z = residual.cwiseQuotient(D);
    const float next = residual.dot(z);
    p = z + (next / rho) * p;
    rho = next;
  }
  return transpose_times(A, v);
}

}  // namespace

Image<float> gauss_field(const std::vector<Vec3>& points, double spacing, const ImageGrid& grid) {
  constexpr float kClear = 0.2F;
  const GaussKernel kernel(points, 2.0 * spacing);
  const Eigen::Index n = kernel.count();
  Rows A(n, 3 * n);
  for_rows(points.size(), [&](Eigen::Index i) {
    Column row(3 * n), scale(n);
    kernel.at(points[static_cast<std::size_t>(i)], row, scale);
    A.row(i) = row.matrix();
  });
  Image<float> field(grid);
  const Eigen::VectorXf area = shortest_with(A, 0.5F);
  const Index3& size = grid.size;
  const auto for_lines = [&](const auto& visit) {  // visit(place, voxel, value there when asked for)
    for_rows(static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(size[2]), [&](Eigen::Index line) {
      Column row(3 * n), scale(n);
      const int j = static_cast<int>(line % size[1]), k = static_cast<int>(line / size[1]);
      for (int i = 0; i < size[0]; ++i) {
        visit(Index3{i, j, k}, field.at(i, j, k), [&] {
          kernel.at(grid.world_from_index(Vec3(i, j, k)), row, scale);
          return row.matrix().dot(area);
        });
      }
    });
  };
  const auto coarse = [](const Index3& at) { return at[0] % 2 + at[1] % 2 + at[2] % 2 == 0; };
  for_lines([&](const Index3& at, float& value, const auto& evaluate) {
    if (coarse(at)) value = evaluate();
  });
  // A voxel between clearly inside (or outside) voxels of the coarse grid is inside (or outside) too.
  for_lines([&](const Index3& at, float& value, const auto& evaluate) {
    if (coarse(at)) return;
    float lo = 1.0F, hi = 0.0F;
    for (int corner = 0; corner < 8; ++corner) {
      Index3 c{};
      for (std::size_t a = 0; a < 3; ++a) {
        const int up = at[a] + at[a] % 2 * (corner >> a & 1);
        c[a] = up < size[a] ? up - up % 2 : at[a] - 1;
      }
      const float there = field.at(c[0], c[1], c[2]);
      lo = std::min(lo, there);
      hi = std::max(hi, there);
    }
    value = hi < kClear ? hi : lo > 1.0F - kClear ? lo : evaluate();
  });
  return field;
}

}  // namespace pellicle
