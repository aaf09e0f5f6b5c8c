#include "pellicle/surface/spline/spline_interpolation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pellicle/base/errors.h"

namespace pellicle {

namespace {

/// Value i of a row of n: itself, or one step beyond either end.
template <class Row>
Vec3 continued(const Row& row, int i, int n) {
  if (i >= 0 && i < n) return row(i);
  const int end = i < 0 ? 0 : n - 1, step = i < 0 ? 1 : -1;
  if (n == 2) return 2.0 * row(end) - row(end + step);
  return 3.0 * row(end) - 3.0 * row(end + step) + row(end + 2 * step);
}

/// Numbers of points that each direction must have.
std::pair<int, int> least_of(SplineTopology topology) {
  switch (topology) {
    case SplineTopology::sphere:
      return {4, 3};
    case SplineTopology::torus:
      return {4, 4};
    case SplineTopology::cylinder:
      return {4, 2};
    case SplineTopology::rectangle:
      break;
  }
  return {2, 2};
}

Parameters of_grid(const PointGrid& grid, const SplineModel& model) {
  const bool u_closed = model.along_u().closed(), v_closed = model.along_v().closed();
  const auto along_u = [&](int k, int l) -> Vec3 {
    return continued([&](int j) -> Vec3 { return grid.at(j, l); }, k, grid.columns);
  };
  Parameters parameters;
  for (int l = v_closed ? 0 : -1; l < grid.rows + (v_closed ? 0 : 1); ++l) {
    for (int k = u_closed ? 0 : -1; k < grid.columns + (u_closed ? 0 : 1); ++k) {
      const Vec3 x = continued([&](int j) { return along_u(k, j); }, l, grid.rows);
      parameters.insert(parameters.end(), x.begin(), x.end());
    }
  }
  return parameters;
}

}  // namespace

std::pair<SplineModel, Parameters> interpolate_grid(const PointGrid& grid, SplineTopology topology) {
  const bool sphere = topology == SplineTopology::sphere;
  const auto [least_u, least_v] = least_of(topology);
  if (grid.columns < least_u || grid.rows < least_v) {
    throw BadData(fmt::format("grid of points (u_index, v_index): {} x {} is too small; a {} takes {} x {} or more",
                              grid.columns, grid.rows, to_string(topology), least_u, least_v));
  }
  const int m1 = topology == SplineTopology::rectangle ? grid.columns - 1 : grid.columns;
  const int m2 = topology == SplineTopology::torus ? grid.rows : grid.rows - 1;
  SplineSettings settings;
  settings.topology = topology;
  settings.m1 = m1;
  settings.m2 = m2;
  const SplineModel model(settings);
  if (!sphere) return {model, of_grid(grid, model)};
  Parameters parameters;
  const auto add = [&](const Vec3& x) { parameters.insert(parameters.end(), {x.x(), x.y(), x.z()}); };
  double extent = 0.0;
  for (const Vec3& x : grid.points) extent = std::max(extent, (x - grid.points.front()).norm());
  for (const int pole : {0, m2}) {
    for (int k = 1; k < m1; ++k) {
      if ((grid.at(k, pole) - grid.at(0, pole)).norm() > 1e-6 * extent) {
        throw BadData(fmt::format(
            "grid of points (v_index {}): the row of a pole must hold one point, {} of them differ", pole, k));
      }
    }
    add(grid.at(0, pole));
  }
  // First harmonic of the row next to the pole; on a sphere it is R sin(pi/M2) and the tangent pi R.
  const auto tangents = [&](int row, double sign) {
    const double factor = sign * std::numbers::pi / std::sin(std::numbers::pi / m2) * 2.0 / m1;
    Vec3 a = Vec3::Zero(), b = Vec3::Zero();
    for (int k = 0; k < m1; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / m1;
      a += std::cos(angle) * grid.at(k, row);
      b += std::sin(angle) * grid.at(k, row);
    }
    add(factor * a);
    add(factor * b);
  };
  tangents(1, 1.0);
  tangents(m2 - 1, -1.0);
  for (int l = 1; l < m2; ++l) {
    for (int k = 0; k < m1; ++k) add(grid.at(k, l));
  }
  return {model, std::move(parameters)};
}

}  // namespace pellicle
