#include "pellicle/solve/dynamics.h"

#include <cmath>

#include "pellicle/energies/geometry.h"

namespace pellicle {

double inertia(const Motion& motion) {
  return motion.mass / (motion.time_step * motion.time_step) + motion.damping / motion.time_step;
}

double delay(const Motion& motion) {
  return 1.0 + 0.5 * inertia(motion);
}

GroupedOperator motion_operator(const Motion& motion, const std::vector<double>& area, const std::vector<Vec3>& x,
                                const SampleLayout& layout) {
  const double total = sum(area);
  VectorRows rows;
  for (std::size_t i = 0; i < area.size(); ++i) {
    rows.add(static_cast<int>(i), std::sqrt(area[i] / total));
    rows.close();
  }
  GroupedOperator op = grouped_operator("motion", inertia(motion), std::move(rows), layout);
  aim_motion(motion, x, x, op);
  return op;
}

void aim_motion(const Motion& motion, const std::vector<Vec3>& x, const std::vector<Vec3>& before,
                GroupedOperator& op) {
  const double carried = motion.mass / (motion.time_step * motion.time_step) / inertia(motion);
  op.rows.target.resize(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    op.rows.target[i] = op.rows.coefficient[i] * (x[i] + carried * (x[i] - before[i]));
  }
}

}  // namespace pellicle
