// Splines through grids of points: every point is met, ellipsoids are exact with their poles.
#include "pellicle/surface/spline/spline_interpolation.h"

#include <gmock/gmock.h>

#include <functional>
#include <numbers>

#include "pellicle/base/errors.h"
#include "pellicle/base/random.h"

namespace pellicle {
namespace {

/// A sphere-like grid: columns around, rows from pole to pole, each point moved by f.
PointGrid sphere_grid(int columns, int rows, const std::function<Vec3(const Vec3&)>& f) {
  PointGrid grid{columns, rows, {}};
  for (int l = 0; l < rows; ++l) {
    for (int k = 0; k < columns; ++k) {
      const double u = 2.0 * std::numbers::pi * k / columns, v = std::numbers::pi * l / (rows - 1);
      const double s = l == 0 || l == rows - 1 ? 0.0 : std::sin(v);
      grid.points.push_back(f(Vec3(s * std::cos(u), s * std::sin(u), l == rows - 1 ? -1.0 : std::cos(v))));
    }
  }
  return grid;
}

TEST(InterpolateGrid, PassesThroughEveryPoint) {
  RandomEngine random(1);
  const PointGrid grid = sphere_grid(7, 6, [&](const Vec3& n) -> Vec3 {
    const double size = std::abs(n.z()) == 1.0 ? 1.0 : 1.0 + 0.2 * random.normal();
    return Vec3(4, 5, 6) + 10.0 * size * n;
  });
  const auto [model, parameters] = interpolate_grid(grid, SplineTopology::sphere);
  for (int l = 0; l < 6; ++l) {
    for (int k = 0; k < 7; ++k) {
      EXPECT_LE((model.at(parameters, k / 7.0, l / 5.0).x - grid.at(k, l)).norm(), 1e-12);
    }
  }
}

TEST(InterpolateGrid, EllipsoidsAreExactBetweenThePointsAndAtThePoles) {
  Mat3 A;
  A << 10, 2, 0, -1, 7, 3, 0.5, 0, 4;
  const auto onto = [&](const Vec3& n) -> Vec3 { return Vec3(1, -2, 3) + A * n; };
  const auto [model, parameters] = interpolate_grid(sphere_grid(8, 5, onto), SplineTopology::sphere);
  RandomEngine random(2);
  for (int i = 0; i < 200; ++i) {
    const double u = random.uniform(), v = i == 0 ? 0.0 : random.uniform();
    EXPECT_LE((model.at(parameters, u, v).x - onto(model.reference_point(u, v))).norm(), 1e-12);
  }
}

TEST(InterpolateGrid, ATorusNeedsNoPoles) {
  PointGrid grid{6, 5, {}};
  RandomEngine random(3);
  for (int i = 0; i < 30; ++i) grid.points.emplace_back(random.normal(), random.normal(), random.normal());
  const auto [model, parameters] = interpolate_grid(grid, SplineTopology::torus);
  EXPECT_LE((model.at(parameters, 2.0 / 6.0, 3.0 / 5.0).x - grid.at(2, 3)).norm(), 1e-12);
}

TEST(InterpolateGrid, OpenOnesMeetEveryPoint) {
  RandomEngine random(4);
  for (const SplineTopology topology : {SplineTopology::cylinder, SplineTopology::rectangle}) {
    for (const int rows : {2, 3, 6}) {
      PointGrid grid{5, rows, {}};
      for (int i = 0; i < 5 * rows; ++i) grid.points.emplace_back(random.normal(), random.normal(), random.normal());
      const auto [model, parameters] = interpolate_grid(grid, topology);
      const double columns = topology == SplineTopology::cylinder ? 5.0 : 4.0;
      for (int l = 0; l < rows; ++l) {
        for (int k = 0; k < 5; ++k) {
          EXPECT_LE((model.at(parameters, k / columns, l / (rows - 1.0)).x - grid.at(k, l)).norm(), 1e-12);
        }
      }
    }
  }
}

TEST(InterpolateGrid, AQuadraticSheetIsExactUpToItsCorners) {
  const auto sheet = [](double u, double v) -> Vec3 {
    return {3.0 * u + u * v, 2.0 * v - u * u, u * u + 0.5 * v * v - 2.0 * u * v};
  };
  PointGrid grid{4, 5, {}};
  for (int l = 0; l < 5; ++l) {
    for (int k = 0; k < 4; ++k) grid.points.push_back(sheet(k / 3.0, l / 4.0));
  }
  const auto [model, parameters] = interpolate_grid(grid, SplineTopology::rectangle);
  RandomEngine random(5);
  for (int i = 0; i < 200; ++i) {
    const double u = i < 4 ? i % 2 : random.uniform(), v = i < 4 ? i / 2 : random.uniform();
    EXPECT_LE((model.at(parameters, u, v).x - sheet(u, v)).norm(), 1e-12) << u << " " << v;
  }
}

TEST(InterpolateGrid, RefusesWhatIsNoSurface) {
  const auto same = [](const Vec3& n) -> Vec3 { return n; };
  EXPECT_THROW(interpolate_grid(sphere_grid(3, 5, same), SplineTopology::sphere), BadData);
  EXPECT_THROW(interpolate_grid(sphere_grid(6, 2, same), SplineTopology::sphere), BadData);
  PointGrid torn = sphere_grid(6, 5, same);
  torn.points[2] += Vec3(0.1, 0, 0);  // a pole that is not a point
  EXPECT_THROW(interpolate_grid(torn, SplineTopology::sphere), BadData);
  EXPECT_THROW(interpolate_grid(sphere_grid(3, 5, same), SplineTopology::cylinder), BadData);
  EXPECT_THROW(interpolate_grid({1, 5, std::vector<Vec3>(5, Vec3::Zero())}, SplineTopology::rectangle), BadData);
}

}  // namespace
}  // namespace pellicle
