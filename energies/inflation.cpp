#include "pellicle/energies/inflation.h"

#include <cmath>

namespace pellicle {

double inflation(double facet_volume, double start_volume, double start_area, double h, double weight,
                 const std::vector<Vec3>& area_vector, std::vector<Vec3>& dE_dx) {
  const double move = (facet_volume - start_volume) / start_area;
  const double longest = 4.0 * h;
  const double damping = std::abs(weight) * h / longest;
  const double slope = (damping * move - weight * h) / start_area;
  for (std::size_t i = 0; i < area_vector.size(); ++i) dE_dx[i] += slope * area_vector[i];
  return (0.5 * damping * move - weight * h) * move;
}

TermOutput InflationTerm::operator()(const StepView& step) const {
  const SampleView& surface = step.surface;
  return {[layout = &surface.layout, volume = surface.volume, area = surface.total_area, h = step.h,
           weight = step.weight](const auto& x, const auto& area_vector, auto& dx, auto&) {
    return inflation(facet_volume(*layout, x), volume, area, h, weight, area_vector, dx);
  }};
}

}  // namespace pellicle
