#include "pellicle/energies/inflation.h"

namespace pellicle {

double inflation(double facet_volume, double start_volume, double start_area, double h, double weight,
                 const std::vector<Vec3>& area_vector, std::vector<Vec3>& dE_dx) {
  const double pressure = weight * h / start_area;
  for (std::size_t i = 0; i < area_vector.size(); ++i) dE_dx[i] -= pressure * area_vector[i];
  return -pressure * (facet_volume - start_volume);
}

}  // namespace pellicle
