#include "pellicle/solve/hold_out.h"

#include <cmath>

#include "pellicle/base/random.h"
#include "pellicle/energies/springs.h"

namespace pellicle {

namespace {

constexpr unsigned kEvery = 4;

double neighbour_correlation(const SampleView& surface, const NormalTargets& targets) {
  const SampleGraph& graph = *surface.graph;
  double products = 0.0, pairs = 0.0, own = 0.0, count = 0.0;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const double here = targets.weight[i] > 0.0 ? targets.offset[i] : 0.0;
    own += here * here;
    count += 1.0;
    for (int k = graph.start[i]; k < graph.start[i + 1]; ++k) {
      const auto j = static_cast<std::size_t>(graph.neighbour[static_cast<std::size_t>(k)]);
      products += here * (targets.weight[j] > 0.0 ? targets.offset[j] : 0.0);
      pairs += 1.0;
    }
  }
  return own > 0.0 ? products / pairs / (own / count) : 1.0;
}

}  // namespace

bool is_held_out(std::size_t item, unsigned n) {
  return RandomEngine(item).next() % n == 0;
}

OffsetErrors measure_offsets(const SampleView& surface, bool hold_out, NormalTargets& targets) {
  OffsetErrors errors;
  errors.neighbour_correlation = neighbour_correlation(surface, targets);
  double squares[2] = {0.0, 0.0}, weights[2] = {0.0, 0.0};
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const bool out = hold_out && is_held_out(i, kEvery);
    const double w = surface.area[i] * targets.weight[i];
    squares[out ? 1 : 0] += w * targets.offset[i] * targets.offset[i];
    weights[out ? 1 : 0] += w;
    if (out) targets.weight[i] = 0.0;
  }
  if (weights[0] > 0.0) errors.rms = std::sqrt(squares[0] / weights[0]);
  if (weights[1] > 0.0) errors.held_out_rms = std::sqrt(squares[1] / weights[1]);
  return errors;
}

double hold_out_points(PointTargets& targets) {
  double squares = 0.0, left_out = 0.0;
  for (std::size_t k = 0; k < targets.at.size(); ++k) {
    if (!is_held_out(k, kEvery)) continue;
    const double distance = targets.at[k].distance;
    squares += targets.robust[k] * distance * distance;
    left_out += targets.given[k];
    targets.given[k] = targets.robust[k] = 0.0;
  }
  return left_out > 0.0 ? squares / left_out : -1.0;
}

ScalarRows spring_rows(const SampleLayout& layout, const PointTargets& targets, double energy_weight) {
  return spring_rows(layout, targets.points->points, targets.at, targets.robust, sum(targets.given),
                     targets.sliding_fraction, energy_weight);
}

}  // namespace pellicle
