#include "pellicle/surface/spline/spline_volume.h"

#include <map>

#include "pellicle/base/errors.h"
#include "pellicle/surface/internal/gauss_legendre.h"

namespace pellicle {
namespace {

double orientation(const SplineModel& model) {
  if (!model.is_closed()) throw UsageError(model.name() + " (volume): is open and encloses none");
  return model.settings().topology == SplineTopology::sphere ? -1.0 : 1.0;
}

std::vector<AxisWeights> basis_at(const SplineAxis& axis, const Quadrature& rule) {
  std::vector<AxisWeights> result;
  for (int cell = 0; cell < axis.m(); ++cell) {
    for (const double at : rule.at) result.push_back(axis.at(cell + at));
  }
  return result;
}

using FourPoints = std::array<Vec3, 4>;

Vec3 combine(const std::array<double, 4>& weights, const FourPoints& points) {
  return weights[0] * points[0] + weights[1] * points[1] + weights[2] * points[2] + weights[3] * points[3];
}

}  // namespace

SplineVolume::SplineVolume(const SplineModel& model, int points) : model_(model), points_(points) {
  orientation(model);
  const Quadrature rule = gauss_legendre(points);
  weight_ = rule.weight;
  by_u_ = basis_at(model.along_u(), rule);
  by_v_ = basis_at(model.along_v(), rule);
}

// Cell by cell, first along u and then along v: 2 x 4 x 4 x points and 3 x 4 x points^2 products of a number with a
// vector instead of 3 x 16 x points^2.
double SplineVolume::sum(const Parameters& parameters, std::vector<Vec3>* gradient) const {
  const std::vector<Vec3> grid = model_.control_grid(parameters);
  const int columns = model_.along_u().rows(), m1 = model_.along_u().m(), m2 = model_.along_v().m();
  const double scale = orientation(model_) / (static_cast<double>(m1) * m2);
  const auto at = [&](const AxisWeights& u, const AxisWeights& v, int a, int b) {
    return u.row[a] + columns * v.row[b];
  };
  double volume = 0.0;
  for (int cell_v = 0; cell_v < m2; ++cell_v) {
    const AxisWeights* const v = &by_v_[static_cast<std::size_t>(cell_v) * points_];
    for (int cell_u = 0; cell_u < m1; ++cell_u) {
      const AxisWeights* const u = &by_u_[static_cast<std::size_t>(cell_u) * points_];
      for (int p = 0; p < points_; ++p) {
        FourPoints line, line_u, normals{Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
        for (int b = 0; b < 4; ++b) {
          const FourPoints c{grid[at(u[p], *v, 0, b)], grid[at(u[p], *v, 1, b)], grid[at(u[p], *v, 2, b)],
                             grid[at(u[p], *v, 3, b)]};
          line[b] = combine(u[p].value, c);
          line_u[b] = combine(u[p].slope, c);
        }
        for (int q = 0; q < points_; ++q) {
          const Vec3 normal = weight_[q] * combine(v[q].value, line_u).cross(combine(v[q].slope, line));
          volume += weight_[p] * combine(v[q].value, line).dot(normal);
          for (int b = 0; b < 4; ++b) normals[b] += v[q].value[b] * normal;
        }
        if (gradient == nullptr) continue;
        for (int b = 0; b < 4; ++b) {
          for (int a = 0; a < 4; ++a) {
            (*gradient)[at(u[p], *v, a, b)] += scale * weight_[p] * u[p].value[a] * normals[b];
          }
        }
      }
    }
  }
  return scale / 3.0 * volume;
}

double SplineVolume::value(const Parameters& parameters) const {
  return sum(parameters, nullptr);
}

double SplineVolume::value_and_gradient(const Parameters& parameters, std::vector<double>& gradient) const {
  std::vector<Vec3> of_grid(static_cast<std::size_t>(model_.along_u().rows()) * model_.along_v().rows(), Vec3::Zero());
  const double volume = sum(parameters, &of_grid);
  model_.pull_back_grid(of_grid, gradient);
  return volume;
}

SplineVolumeForm::SplineVolumeForm(const SplineModel& model)
    : model_(model), by_u_(table_of(model.along_u())), by_v_(table_of(model.along_v())) {
  orientation(model);
}

std::vector<SplineVolumeForm::Entry> SplineVolumeForm::table_of(const SplineAxis& axis) {
  constexpr int kPoints = 12;  // products of three generators: exact to rounding
  const Quadrature rule = gauss_legendre(kPoints);
  const std::vector<AxisWeights> basis = basis_at(axis, rule);
  std::map<std::array<int, 3>, std::array<double, 2>> entries;
  for (std::size_t p = 0; p < basis.size(); ++p) {
    const AxisWeights& b = basis[p];
    const double weight = rule.weight[p % kPoints] / axis.m();
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        for (int k = 0; k < 4; ++k) {
          auto& [d, e] = entries[{b.row[i], b.row[j], b.row[k]}];
          d += weight * b.value[i] * b.slope[j] * b.value[k];
          e += weight * b.value[i] * b.value[j] * b.slope[k];
        }
      }
    }
  }
  std::vector<Entry> result;
  result.reserve(entries.size());
  for (const auto& [rows, values] : entries) result.push_back({rows[0], rows[1], rows[2], values[0], values[1]});
  return result;
}

double SplineVolumeForm::value_and_gradient(const Parameters& parameters, std::vector<double>& gradient) const {
  const std::vector<Vec3> c = model_.control_grid(parameters);
  const int columns = model_.along_u().rows();
  const double sign = orientation(model_);
  std::vector<Vec3> of_grid(c.size(), Vec3::Zero());
  double volume = 0.0;
  for (const Entry& v : by_v_) {
    const int row_i = columns * v.i, row_j = columns * v.j, row_k = columns * v.k;
    for (const Entry& u : by_u_) {
      const double t = sign * (u.d * v.e - u.e * v.d);
      const int i = row_i + u.i, j = row_j + u.j, k = row_k + u.k;
      const double x = c[i].x(), y = c[j].y(), z = c[k].z();
      volume += t * x * y * z;
      of_grid[i].x() += t * y * z;
      of_grid[j].y() += t * x * z;
      of_grid[k].z() += t * x * y;
    }
  }
  model_.pull_back_grid(of_grid, gradient);
  return volume;
}

}  // namespace pellicle
