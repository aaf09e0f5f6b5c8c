#pragma once
/// Spline surfaces that several tests look at.

#include "pellicle/surface/spline/spline_model.h"
#include "shapes.h"

namespace pellicle::shapes {

inline nlohmann::json spline_golden(const std::string& section) {
  std::ifstream in(std::string(PELLICLE_SOURCE_DIR) + "/tests/golden/spline.json");
  return nlohmann::json::parse(in).at(section);
}

inline SplineModel spline_sphere(int m1, int m2, SplineGenerator generator = SplineGenerator::exponential) {
  return SplineModel({.topology = SplineTopology::sphere, .m1 = m1, .m2 = m2, .generator = generator});
}

/// The reference shape with every number moved by up to `amplitude`.
inline Parameters perturbed(const SplineModel& model, double amplitude, RandomEngine& random) {
  Parameters result(model.reference());
  for (double& x : result) x += random.uniform(-amplitude, amplitude);
  return result;
}

/// Golden files list the control points before the poles.
inline Parameters in_block_order(const nlohmann::json& rows) {
  Parameters result;
  const std::size_t n = rows.size();
  const auto append = [&](std::size_t i) {
    for (const auto& x : rows.at(i)) result.push_back(x.get<double>());
  };
  for (std::size_t i = n - 6; i < n; ++i) append(i);
  for (std::size_t i = 0; i < n - 6; ++i) append(i);
  return result;
}

inline Vec3 block(const Parameters& parameters, int b) {
  return Vec3(&parameters[3 * std::size_t(b)]);
}

/// One model of each topology.
inline std::vector<SplineModel> all_splines() {
  return {spline_sphere(5, 3),
          spline_sphere(4, 2),
          spline_sphere(6, 4, SplineGenerator::keys),
          SplineModel({.topology = SplineTopology::torus, .m1 = 6, .m2 = 4}),
          SplineModel({.topology = SplineTopology::cylinder, .m1 = 5, .m2 = 2}),
          SplineModel({.topology = SplineTopology::rectangle, .m1 = 3, .m2 = 1})};
}

}  // namespace pellicle::shapes
