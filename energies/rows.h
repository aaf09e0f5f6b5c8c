#pragma once
/// Residual energies, once their targets are drawn, are linear in the sample positions: r = C x - d. They hand over C
/// and d; fit applies the chain rule to the parameters in one place.

#include <vector>

#include "pellicle/base/geometry.h"
#include "pellicle/energies/sample_view.h"

namespace pellicle {

/// Rows r_k = sum_j c_kj . x_j - d_k with a 3-vector c_kj for every sample j of the row. Half the sum of squares is the
/// energy in mm^2, so weights are square-rooted into C and d.
struct ScalarRows {
  std::vector<int> start{0}, sample;
  std::vector<Vec3> coefficient;
  std::vector<double> target;
  std::size_t size() const { return target.size(); }
  void add(int s, const Vec3& c) {
    sample.push_back(s);
    coefficient.push_back(c);
  }
  void close(double d) {
    target.push_back(d);
    start.push_back(static_cast<int>(sample.size()));
  }
  double residual(std::size_t row, const std::vector<Vec3>& x) const {
    double r = -target[row];
    for (auto k = static_cast<std::size_t>(start[row]); k < static_cast<std::size_t>(start[row + 1]); ++k) {
      r += coefficient[k].dot(x[static_cast<std::size_t>(sample[k])]);
    }
    return r;
  }
};

/// Rows of three residuals r_k = sum_j c_kj x_j - d_k with scalar c_kj: operators that treat the three coordinates in
/// the same way.
struct VectorRows {
  std::vector<int> start{0}, sample;
  std::vector<double> coefficient;
  std::vector<Vec3> target;  ///< d, one per row; empty: zero
  std::size_t size() const { return start.size() - 1; }
  void add(int s, double c) {
    sample.push_back(s);
    coefficient.push_back(c);
  }
  void close() { start.push_back(static_cast<int>(sample.size())); }
  Vec3 residual(std::size_t row, const std::vector<Vec3>& x) const {
    Vec3 r = target.empty() ? Vec3(Vec3::Zero()) : Vec3(-target[row]);
    for (auto k = static_cast<std::size_t>(start[row]); k < static_cast<std::size_t>(start[row + 1]); ++k) {
      r += coefficient[k] * x[static_cast<std::size_t>(sample[k])];
    }
    return r;
  }
};

/// Where each sample should go: along its normal, and how sure that is.
struct NormalTargets {
  std::vector<double> offset = {};      ///< mm, positive outward, as measured
  std::vector<double> weight = {};      ///< >= 0; 1 is a clear edge
  std::vector<double> correction = {};  ///< mm, added to the offsets once outliers are weighed; empty: none
};

/// Multiplies the weights by 1/(1 + ((t - m)/(3 s))^2), m the median of the offsets, s their robust spread plus 0.05 h.
void downweight_outliers(double h, NormalTargets& targets);

/// Adds the correction to the offsets, and clears it.
void apply_correction(NormalTargets& targets);

/// sum_i (A_i/A) w_i (n_i . (x_i - x0_i) - t_i)^2 as rows; samples without weight get none.
ScalarRows offset_rows(const SampleView& surface, const NormalTargets& targets, double energy_weight);

}  // namespace pellicle
