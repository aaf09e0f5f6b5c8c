// The same spline surface with other control points. See spline_model.h.

#include <Eigen/Dense>
#include <cmath>

#include "pellicle/base/constants.h"
#include "pellicle/base/errors.h"
#include "pellicle/surface/spline/spline_model.h"

namespace pellicle {
namespace {

/// 4, 6, 10, 16, 24, 36 ...; 1, 2, 4, 6 ...
int next_size(int m) {
  return 2 * ((3 * m + 3) / 4);
}

using GridRow = Eigen::RowVectorXd;

GridRow row_of(const SplineAxis& axis, const AxisWeights& at, const std::array<double, 4>& weights) {
  GridRow row = GridRow::Zero(axis.rows());
  for (int a = 0; a < 4; ++a) row[at.row[a]] += weights[a];
  return row;
}

/// Control points on the same curve at the knots of `to`; open ends keep their slope.
Eigen::MatrixXd knots_of(const SplineAxis& from, const SplineAxis& to) {
  Eigen::MatrixXd result(to.rows(), from.rows());
  for (int k = 0; k <= (to.closed() ? to.m() - 1 : to.m()); ++k) {
    const AxisWeights at = from.at(static_cast<double>(k) * from.m() / to.m());
    result.row(to.row(k)) = row_of(from, at, at.value);
  }
  if (to.closed()) return result;
  const double scale = 1.0 / (to.m() * to.phi().slope_at_one());
  const AxisWeights begin = from.at(0), end = from.at(from.m());
  result.row(to.row(-1)) = result.row(to.row(1)) + scale * row_of(from, begin, begin.slope);
  result.row(to.row(to.m() + 1)) = result.row(to.row(to.m() - 1)) - scale * row_of(from, end, end.slope);
  return result;
}

/// A direction on the reference sphere as parameters; `pole` 1 or -1 where u means next to nothing.
struct Direction {
  double u = 0.0, v = 0.0;
  int pole = 0;
  explicit Direction(const Vec3& d) {
    const double rho = std::hypot(d.x(), d.y());
    u = std::atan2(d.y(), d.x()) / (2.0 * kPi);
    if (u < 0.0) u += 1.0;
    v = std::atan2(rho, d.z()) / kPi;
    constexpr double kPole = 1e-8;  // nearer, sigma_u / sin(pi v) cancels
    if (rho < kPole) pole = d.z() > 0.0 ? 1 : -1;
  }
};

/// Derivative of the surface, as a function on the unit sphere, at d along the tangent w.
Vec3 derivative(const SplineModel& model, const Parameters& parameters, const Vec3& d, const Vec3& w) {
  const Direction at(d);
  if (at.pole != 0) {  // sigma_v = T1 cos 2 pi u + T2 sin 2 pi u; dd/dv = +-pi (cos 2 pi u, sin 2 pi u, 0)
    const double* const tangents = parameters.data() + (at.pole > 0 ? 6 : 12);
    return at.pole / kPi * (w.x() * Vec3(tangents) + w.y() * Vec3(tangents + 3));
  }
  const double phi = 2.0 * kPi * at.u, theta = kPi * at.v;
  const Vec3 east(-std::sin(phi), std::cos(phi), 0.0);
  const Vec3 south(std::cos(phi) * std::cos(theta), std::sin(phi) * std::cos(theta), -std::sin(theta));
  const SplinePoint p = model.at(parameters, at.u, at.v);
  return w.dot(south) / kPi * p.x_v + w.dot(east) / (2.0 * kPi * std::sin(theta)) * p.x_u;
}

void set(Parameters& parameters, int block, const Vec3& x) {
  Eigen::Map<Vec3>(parameters.data() + 3 * static_cast<std::ptrdiff_t>(block)) = x;
}

}  // namespace

std::pair<SplineModel, Parameters> SplineModel::refine(const Parameters& parameters) const {
  return resampled(parameters, next_size(settings_.m1), next_size(settings_.m2));
}

std::pair<SplineModel, Parameters> SplineModel::resampled(const Parameters& parameters, int m1, int m2) const {
  SplineSettings settings = settings_;
  settings.m1 = m1;
  settings.m2 = m2;
  SplineModel fine(settings);
  const std::vector<Vec3> grid = control_grid(parameters);
  const Eigen::Map<const Eigen::Matrix<double, 3, Eigen::Dynamic>> points(grid.front().data(), 3,
                                                                          static_cast<Eigen::Index>(grid.size()));
  const Eigen::MatrixXd by_u = knots_of(along_u_, fine.along_u_), by_v = knots_of(along_v_, fine.along_v_);
  std::array<Eigen::MatrixXd, 3> result;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::VectorXd coordinate = points.row(axis);
    const Eigen::Map<const Eigen::MatrixXd> coarse(coordinate.data(), along_u_.rows(), along_v_.rows());
    result[axis] = by_u * coarse * by_v.transpose();
  }
  Parameters refined = fine.reference_;
  const bool sphere = settings.topology == SplineTopology::sphere;
  if (sphere) std::copy_n(parameters.begin(), 18, refined.begin());
  for (int row_v = sphere ? 2 : 0; row_v < (sphere ? settings.m2 + 1 : fine.along_v_.rows()); ++row_v) {
    for (int row_u = 0; row_u < fine.along_u_.rows(); ++row_u) {
      set(refined, fine.control(row_u, row_v).front().block,
          {result[0](row_u, row_v), result[1](row_u, row_v), result[2](row_u, row_v)});
    }
  }
  return {std::move(fine), std::move(refined)};
}

int SplineModel::refinements() const {
  const auto points = [](const SplineSettings& s) { return std::log(static_cast<double>(s.m1) * s.m2); };
  const double wanted = points(settings_);
  SplineSettings rung = start_spline(settings_.topology).settings_;
  for (int count = 0;; ++count) {
    SplineSettings next = rung;
    next.m1 = next_size(rung.m1);
    next.m2 = next_size(rung.m2);
    if (wanted <= 0.5 * (points(rung) + points(next))) return count;
    rung = next;
  }
}

SplineModel start_spline(SplineTopology topology) {
  switch (topology) {
    case SplineTopology::sphere:
      return SplineModel({.topology = topology, .m1 = 4, .m2 = 2});
    case SplineTopology::torus:
      return SplineModel({.topology = topology, .m1 = 6, .m2 = 4});
    case SplineTopology::cylinder:
      return SplineModel({.topology = topology, .m1 = 4, .m2 = 1});
    case SplineTopology::rectangle:
      break;
  }
  return SplineModel({.topology = SplineTopology::rectangle, .m1 = 1, .m2 = 1});
}

Parameters place_poles(const SplineModel& model, const Parameters& parameters, const Vec3& axis) {
  if (model.settings().topology != SplineTopology::sphere) {
    throw UsageError("spline " + to_string(model.settings().topology) + " (poles): has none to place");
  }
  if (!(axis.norm() > 0.0)) throw UsageError("spline sphere (axis of the poles): has length zero");
  const Mat3 turn = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), axis).toRotationMatrix();
  const auto point = [&](const Vec3& before) {
    const Direction at(turn * before);
    return model.at(parameters, at.u, at.v).x;
  };
  Parameters result = parameters;
  const Vec3 north = turn.col(2);
  set(result, 0, point(Vec3::UnitZ()));
  set(result, 1, point(-Vec3::UnitZ()));
  for (int t = 0; t < 2; ++t) {
    set(result, 2 + t, kPi * derivative(model, parameters, north, turn.col(t)));
    set(result, 4 + t, -kPi * derivative(model, parameters, -north, turn.col(t)));
  }
  const auto [topology, m1, m2, generator, ratio] = model.settings();
  for (int l = 1; l < m2; ++l) {
    for (int k = 0; k < m1; ++k) {
      const Vec3 before = model.reference_point(static_cast<double>(k) / m1, static_cast<double>(l) / m2);
      set(result, model.control(k, l + 1).front().block, point(before));
    }
  }
  return result;
}

}  // namespace pellicle
