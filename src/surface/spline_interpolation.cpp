#include "pellicle/surface/spline_interpolation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pellicle/base/errors.h"

namespace pellicle {

std::pair<SplineModel, Parameters> interpolate_grid(const PointGrid& grid, SplineTopology topology) {
  if (topology != SplineTopology::sphere && topology != SplineTopology::torus) {
    throw BadData(fmt::format("grid of points ({}): only spheres and tori are interpolated", to_string(topology)));
  }
  const bool sphere = topology == SplineTopology::sphere;
  const int m1 = grid.columns, m2 = sphere ? grid.rows - 1 : grid.rows;
  if (m1 < 4 || m2 < (sphere ? 2 : 4)) {
    throw BadData(fmt::format("grid of points (u_index, v_index): {} x {} is too small; a {} takes 4 x {} or more",
                              grid.columns, grid.rows, to_string(topology), sphere ? 3 : 4));
  }
  SplineSettings settings;
  settings.topology = topology;
  settings.m1 = m1;
  settings.m2 = m2;
  const SplineModel model(settings);
  Parameters parameters;
  const auto add = [&](const Vec3& x) { parameters.insert(parameters.end(), {x.x(), x.y(), x.z()}); };
  if (!sphere) {
    for (const Vec3& x : grid.points) add(x);
    return {model, std::move(parameters)};
  }
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
