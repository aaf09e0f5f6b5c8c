#include "pellicle/energies/geometry.h"

#include <algorithm>
#include <cmath>

namespace pellicle {

namespace {
std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}
}  // namespace

SampleGraph::SampleGraph(const SampleLayout& layout) {
  const std::size_t n = layout.patch_of.size();
  start.assign(n + 1, 0);
  // Every inner edge of a closed oriented mesh is run through once each way: one entry a direction.
  for (const auto& t : layout.triangles) {
    for (const int v : t) ++start[at(v) + 1];
  }
  for (std::size_t i = 0; i < n; ++i) start[i + 1] += start[i];
  neighbour.resize(at(start[n]));
  std::vector<int> next(start.begin(), start.end() - 1);
  for (const auto& t : layout.triangles) {
    for (std::size_t c = 0; c < 3; ++c) neighbour[at(next[at(t[c])]++)] = t[(c + 1) % 3];
  }
  for (std::size_t i = 0; i < n; ++i) std::sort(neighbour.begin() + start[i], neighbour.begin() + start[i + 1]);
}

std::vector<double> sample_areas(const SampleLayout& layout, const std::vector<Vec3>& x) {
  std::vector<double> area(x.size(), 0.0);
  for (const auto& t : layout.triangles) {
    const double a = (x[at(t[1])] - x[at(t[0])]).cross(x[at(t[2])] - x[at(t[0])]).norm() / 6.0;
    for (const int v : t) area[at(v)] += a;
  }
  return area;
}

double sum(std::span<const double> values) {
  double total = 0.0;
  for (const double v : values) total += v;
  return total;
}

std::vector<Vec3> area_vectors(const SampleLayout& layout, const std::vector<Vec3>& x) {
  std::vector<Vec3> area(x.size(), Vec3::Zero());
  for (const auto& t : layout.triangles) {
    const Vec3 a = (x[at(t[1])] - x[at(t[0])]).cross(x[at(t[2])] - x[at(t[0])]) / 6.0;
    for (const int v : t) area[at(v)] += a;
  }
  return area;
}

void pull_back_area_vectors(const SampleLayout& layout, const std::vector<Vec3>& x, const std::vector<Vec3>& dE_da,
                            std::vector<Vec3>& dE_dx) {
  for (const auto& t : layout.triangles) {
    const Vec3 bar = (dE_da[at(t[0])] + dE_da[at(t[1])] + dE_da[at(t[2])]) / 6.0;
    // a = u x v with u = x1 - x0, v = x2 - x0: d(bar . a) = du . (v x bar) + dv . (bar x u)
    const Vec3 u = x[at(t[1])] - x[at(t[0])], v = x[at(t[2])] - x[at(t[0])];
    const Vec3 du = v.cross(bar), dv = bar.cross(u);
    dE_dx[at(t[1])] += du;
    dE_dx[at(t[2])] += dv;
    dE_dx[at(t[0])] -= du + dv;
  }
}

double facet_volume(const SampleLayout& layout, const std::vector<Vec3>& x) {
  // About the first sample: no cancellation far from the world's origin.
  double six = 0.0;
  for (const auto& t : layout.triangles) {
    six += (x[at(t[0])] - x[0]).dot((x[at(t[1])] - x[0]).cross(x[at(t[2])] - x[0]));
  }
  return six / 6.0;
}

void average_over_mesh(const SampleGraph& graph, int rounds, std::vector<double>& values) {
  std::vector<double> next(values.size());
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      double total = 0.0;
      int count = 0;
      const auto add = [&](double v) {
        if (!std::isnan(v)) {
          total += v;
          ++count;
        }
      };
      add(values[i]);
      for (int k = graph.start[i]; k < graph.start[i + 1]; ++k) add(values[at(graph.neighbour[at(k)])]);
      next[i] = count > 0 ? total / count : values[i];
    }
    values.swap(next);
  }
}

}  // namespace pellicle
