#include "pellicle/solve/linear_system.h"

#include <omp.h>
#include <Eigen/CholmodSupport>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "pellicle/surface/linear_stencils.h"

namespace pellicle {

namespace {

/// Where a sample's weights begin.
std::size_t weights_of(const SamplePatch& patch, int sample) {
  return patch.jacobian_offset / 9 + static_cast<std::size_t>(sample - patch.first_sample) * patch.blocks.size();
}

const SamplePatch& patch_of(const SampleLayout& layout, int sample) {
  return layout.patches[static_cast<std::size_t>(layout.patch_of[static_cast<std::size_t>(sample)])];
}

// L W of one operator, weighted.
Eigen::SparseMatrix<double> over_blocks(const SampleLayout& layout, std::size_t blocks, const GroupedOperator& op) {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t row = 0; row < op.rows.size(); ++row) {
    for (auto k = static_cast<std::size_t>(op.rows.start[row]); k < static_cast<std::size_t>(op.rows.start[row + 1]);
         ++k) {
      const int sample = op.rows.sample[k];
      const SamplePatch& patch = patch_of(layout, sample);
      const std::size_t first = weights_of(patch, sample);
      for (std::size_t b = 0; b < patch.blocks.size(); ++b) {
        entries.emplace_back(static_cast<int>(row), patch.blocks[b],
                             op.root_weight * op.rows.coefficient[k] * layout.stencils->x[first + b]);
      }
    }
  }
  Eigen::SparseMatrix<double> result(static_cast<Eigen::Index>(op.rows.size()), static_cast<Eigen::Index>(blocks));
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

// The row blocks at or below the diagonal that each column block meets: in an operator, in a patch, or across a facet.
std::vector<std::set<int>> meetings(const SampleLayout& layout, const Eigen::SparseMatrix<double>& operators,
                                    std::size_t blocks) {
  std::set<std::pair<int, int>> patches;
  for (int p = 0; p < static_cast<int>(layout.patches.size()); ++p) patches.insert({p, p});
  for (const auto& t : layout.triangles) {
    for (std::size_t c = 0; c < 3; ++c) {
      const int p = layout.patch_of[static_cast<std::size_t>(t[c])];
      const int q = layout.patch_of[static_cast<std::size_t>(t[(c + 1) % 3])];
      patches.insert({std::min(p, q), std::max(p, q)});
    }
  }
  std::vector<std::set<int>> below(blocks);
  for (const auto& [p, q] : patches) {
    for (const int i : layout.patches[static_cast<std::size_t>(p)].blocks) {
      for (const int j : layout.patches[static_cast<std::size_t>(q)].blocks) {
        below[static_cast<std::size_t>(std::min(i, j))].insert(std::max(i, j));
      }
    }
  }
  for (int column = 0; column < operators.outerSize(); ++column) {
    below[static_cast<std::size_t>(column)].insert(column);
    for (Eigen::SparseMatrix<double>::InnerIterator it(operators, column); it; ++it) {
      if (it.row() >= column) below[static_cast<std::size_t>(column)].insert(static_cast<int>(it.row()));
    }
  }
  return below;
}

}  // namespace

/// Supernodes: a surface's neighbourhoods fill up to dense blocks.
struct LinearSystem::Factor {
  Eigen::CholmodSupernodalLLT<Matrix> cholesky;
};

LinearSystem::~LinearSystem() = default;

LinearSystem::LinearSystem(const SampleLayout& layout, std::size_t blocks,
                           const std::vector<GroupedOperator>& operators)
    : layout_(layout) {
  const auto n = static_cast<Eigen::Index>(blocks);
  operators_ = Matrix(n, n);
  for (const GroupedOperator& op : operators) {
    const Matrix rows = over_blocks(layout, blocks, op);
    operators_ += Matrix(rows.transpose() * rows);
    if (!op.rows.target.empty()) aimed_.emplace_back(&op, rows);
  }
  const std::vector<std::set<int>> below = meetings(layout, operators_, blocks);
  start_.push_back(0);
  for (const std::set<int>& rows : below) {
    at_.insert(at_.end(), rows.begin(), rows.end());
    start_.push_back(static_cast<int>(at_.size()));
  }
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(9 * at_.size());
  for (int column = 0; column < static_cast<int>(blocks); ++column) {
    for (int k = start_[static_cast<std::size_t>(column)]; k < start_[static_cast<std::size_t>(column) + 1]; ++k) {
      const int row = at_[static_cast<std::size_t>(k)];
      for (int j = 0; j < 3; ++j) {
        for (int i = row == column ? j : 0; i < 3; ++i) entries.emplace_back(3 * row + i, 3 * column + j, 0.0);
      }
    }
  }
  normal_ = Matrix(3 * n, 3 * n);
  normal_.setFromTriplets(entries.begin(), entries.end());
}

// Column 3 c + j of the matrix begins with the lower part of the diagonal block, then three entries a block.
bool LinearSystem::add_block(int row_block, int column_block, const Mat3& value) {
  const auto column = static_cast<std::size_t>(column_block);
  const auto first = at_.begin() + start_[column], last = at_.begin() + start_[column + 1];
  const auto at = std::lower_bound(first, last, row_block);
  if (at == last || *at != row_block) return false;
  const auto place = static_cast<int>(at - first);
  for (int j = 0; j < 3; ++j) {
    double* entry = normal_.valuePtr() + normal_.outerIndexPtr()[3 * column_block + j];
    if (place == 0) {
      for (int i = j; i < 3; ++i) entry[i - j] += value(i, j);
    } else {
      entry += 3 - j + 3 * (place - 1);
      for (int i = 0; i < 3; ++i) entry[i] += value(i, j);
    }
  }
  return true;
}

bool LinearSystem::add_row(const ScalarRows& rows, std::size_t row, const Parameters& parameters,
                           Eigen::VectorXd& gradient) {
  auto& v = derivative_;
  v.clear();
  for (auto k = static_cast<std::size_t>(rows.start[row]); k < static_cast<std::size_t>(rows.start[row + 1]); ++k) {
    const SamplePatch& patch = patch_of(layout_, rows.sample[k]);
    const std::size_t first = weights_of(patch, rows.sample[k]);
    for (std::size_t b = 0; b < patch.blocks.size(); ++b) {
      v.emplace_back(patch.blocks[b], layout_.stencils->x[first + b] * rows.coefficient[k]);
    }
  }
  std::stable_sort(v.begin(), v.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::size_t used = 0;
  for (std::size_t i = 0; i < v.size(); ++i) {
    if (used > 0 && v[used - 1].first == v[i].first) {
      v[used - 1].second += v[i].second;
    } else {
      v[used++] = v[i];
    }
  }
  v.resize(used);
  double residual = -rows.target[row];
  for (const auto& [block, d] : v) residual += d.dot(Vec3(parameters.data() + 3 * static_cast<std::size_t>(block)));
  bool known = true;
  for (std::size_t j = 0; j < v.size(); ++j) {
    gradient.segment<3>(3 * v[j].first) += residual * v[j].second;
    for (std::size_t i = j; i < v.size(); ++i) {
      known = add_block(v[i].first, v[j].first, v[i].second * v[j].second.transpose()) && known;
    }
  }
  return known;
}

std::optional<Eigen::VectorXd> LinearSystem::solved_for(const Eigen::VectorXd& right) {
  omp_set_num_threads(1);  // as in solve.cpp
  if (!factor_) {
    factor_ = std::make_unique<Factor>();
    factor_->cholesky.analyzePattern(normal_);
  }
  factor_->cholesky.factorize(normal_);
  if (factor_->cholesky.info() != Eigen::Success) return std::nullopt;
  Eigen::VectorXd x = factor_->cholesky.solve(right);
  if (!x.allFinite()) return std::nullopt;
  return x;
}

// Rows of one sample each, which most are: w_a w_b v v^T for each pair of the patch's blocks. Summed over the patch
// first, so that the sparse matrix is searched once a patch and not once a row.
bool LinearSystem::add_single_rows(const NamedRows& named, const Parameters& parameters, Eigen::VectorXd& gradient) {
  const ScalarRows& rows = named.rows;
  bool known = true;
  for (std::size_t row = 0; row < rows.size();) {
    const int patch_index = layout_.patch_of[static_cast<std::size_t>(rows.sample[row])];
    const SamplePatch& patch = layout_.patches[static_cast<std::size_t>(patch_index)];
    const std::size_t n = patch.blocks.size();
    local_.assign(6 * n * n, 0.0);
    for (; row < rows.size() && layout_.patch_of[static_cast<std::size_t>(rows.sample[row])] == patch_index; ++row) {
      const double* w = layout_.stencils->x.data() + weights_of(patch, rows.sample[row]);
      const Vec3& v = rows.coefficient[row];
      double residual = -rows.target[row];
      for (std::size_t a = 0; a < n; ++a) {
        residual += w[a] * v.dot(Vec3(parameters.data() + 3 * static_cast<std::size_t>(patch.blocks[a])));
      }
      const std::array<double, 6> square{v[0] * v[0], v[0] * v[1], v[0] * v[2], v[1] * v[1], v[1] * v[2], v[2] * v[2]};
      for (std::size_t a = 0; a < n; ++a) {
        gradient.segment<3>(3 * patch.blocks[a]) += residual * w[a] * v;
        double* out = local_.data() + 6 * n * a;
        for (std::size_t b = 0; b <= a; ++b, out += 6) {
          const double both = w[a] * w[b];
          for (std::size_t c = 0; c < 6; ++c) out[c] += both * square[c];
        }
      }
    }
    for (std::size_t a = 0; a < n; ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        const double* s = local_.data() + 6 * (n * a + b);
        Mat3 value;
        value << s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5];
        const int i = patch.blocks[a], j = patch.blocks[b];
        known = add_block(std::max(i, j), std::min(i, j), value) && known;
      }
    }
  }
  return known;
}

// K c - (L W)^T t, and K into the matrix.
bool LinearSystem::add_operators(const Parameters& parameters, Eigen::VectorXd& gradient) {
  bool known = true;
  for (int column = 0; column < operators_.outerSize(); ++column) {
    for (Matrix::InnerIterator it(operators_, column); it; ++it) {
      const auto row = static_cast<int>(it.row());
      gradient.segment<3>(3 * row) += it.value() * Vec3(parameters.data() + 3 * static_cast<std::size_t>(column));
      if (row >= column) known = add_block(row, column, it.value() * Mat3::Identity()) && known;
    }
  }
  for (const auto& [op, rows] : aimed_) {
    for (int column = 0; column < rows.outerSize(); ++column) {
      for (Matrix::InnerIterator it(rows, column); it; ++it) {
        const Vec3& target = op->rows.target[static_cast<std::size_t>(it.row())];
        gradient.segment<3>(3 * column) -= op->root_weight * it.value() * target;
      }
    }
  }
  return known;
}

bool LinearSystem::minimise(const std::vector<NamedRows>& rows, Parameters& parameters) {
  const Eigen::Index size = normal_.cols();
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(size);
  std::fill_n(normal_.valuePtr(), normal_.nonZeros(), 0.0);
  bool known = add_operators(parameters, gradient);
  for (const NamedRows& named : rows) {
    if (named.rows.sample.size() == named.rows.size()) {
      known = add_single_rows(named, parameters, gradient) && known;
      continue;
    }
    for (std::size_t row = 0; row < named.rows.size(); ++row) {
      known = add_row(named.rows, row, parameters, gradient) && known;
    }
  }
  double largest = 0.0;
  for (Eigen::Index i = 0; i < size; ++i) largest = std::max(largest, normal_.coeff(i, i));
  if (!known || !gradient.allFinite() || !(largest > 0.0) || !std::isfinite(largest)) return false;
  // What nothing holds (a part of the surface without data) stays where it is.
  for (Eigen::Index i = 0; i < size; ++i) normal_.coeffRef(i, i) += 1e-10 * largest;
  const std::optional<Eigen::VectorXd> solved = solved_for(gradient);
  if (!solved) return false;
  const Eigen::VectorXd& step = *solved;
  for (Eigen::Index i = 0; i < size; ++i) parameters[static_cast<std::size_t>(i)] -= step[i];
  return true;
}

}  // namespace pellicle
