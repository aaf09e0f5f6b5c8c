#include "pellicle/energies/volume.h"

#include <cmath>
#include <numbers>

#include "pellicle/mesh/measure.h"

namespace pellicle {

double volume_prior(double facet_volume, double correction, double target, double weight,
                    const std::vector<Vec3>& area_vector, std::vector<Vec3>& dE_dx) {
  const double radius = std::cbrt(3.0 * target / (4.0 * std::numbers::pi));
  const double error = (correction * facet_volume - target) / (3.0 * target);
  const double slope = weight * radius * radius * error * correction / (3.0 * target);
  for (std::size_t i = 0; i < area_vector.size(); ++i) dE_dx[i] += slope * area_vector[i];
  return 0.5 * weight * radius * radius * error * error;
}

TermOutput VolumeTerm::operator()(const StepView& step) const {
  if (!step.target_volume) return {};
  const double correction = volume_with_normals(mesh_of(step.surface)) / step.surface.volume;
  return {[layout = &step.surface.layout, correction, target = *step.target_volume, weight = step.weight](
              const auto& x, const auto& area, auto& dx, auto&) {
    return volume_prior(facet_volume(*layout, x), correction, target, weight, area, dx);
  }};
}

}  // namespace pellicle
