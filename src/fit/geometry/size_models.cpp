#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "pellicle/fit/geometry/internal/size_models.h"

namespace pellicle {

namespace {

// M1 and M2 of splines.
constexpr std::pair<int, int> kSplineSizes[] = {{4, 2},   {6, 3},   {6, 5},   {8, 6},   {10, 7},  {12, 9},  {14, 12},
                                                {16, 15}, {20, 18}, {24, 22}, {30, 26}, {36, 32}, {44, 40}, {52, 50}};

}  // namespace

std::string name_of_size(const SurfaceModel& model) {
  if (const auto* spline = std::get_if<SplineModel>(&model)) {
    return fmt::format("{} x {}", spline->settings().m1, spline->settings().m2);
  }
  return fmt::format("{} points", control_point_count(model));
}

SurfaceModel refined(const SurfaceModel& model) {
  return refine(Surface{model, affine_image(model, Vec3::Zero(), Mat3::Identity())}).model;
}

SurfaceModel spline_of(int m1, int m2) {
  SplineSettings spline;
  spline.m1 = m1;
  spline.m2 = m2;
  return SplineModel(spline);
}

std::vector<SurfaceModel> sizes_of(const ModelChoice& choice) {
  std::vector<SurfaceModel> sizes;
  if (choice.kind == ModelKind::spline) {
    for (const auto& [m1, m2] : kSplineSizes) {
      sizes.push_back(spline_of(m1, m2));
    }
    return sizes;
  }
  for (const StartSolid solid : {StartSolid::tetrahedron, StartSolid::octahedron, StartSolid::icosahedron}) {
    SurfaceModel model = NormalModel::start(solid, choice.rule);
    while (control_point_count(model) <= kMostForTolerance) {
      sizes.push_back(model);
      model = refined(model);
    }
  }
  std::stable_sort(sizes.begin(), sizes.end(), [](const SurfaceModel& a, const SurfaceModel& b) {
    return control_point_count(a) < control_point_count(b);
  });
  return sizes;
}

}  // namespace pellicle
