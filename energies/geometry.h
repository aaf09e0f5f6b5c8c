#pragma once
/// The sampled surface as the energies see it: areas, neighbours, averages over the mesh.

#include <span>
#include <vector>

#include "pellicle/surface/samples.h"

namespace pellicle {

/// Neighbours of every sample along the edges of the sample mesh (compressed rows, ascending).
struct SampleGraph {
  std::vector<int> start, neighbour;
  explicit SampleGraph(const SampleLayout& layout);
  int degree(int sample) const {
    return start[static_cast<std::size_t>(sample) + 1] - start[static_cast<std::size_t>(sample)];
  }
};

/// A third of the facets around each sample, mm^2; the sum is the surface's area.
std::vector<double> sample_areas(const SampleLayout& layout, const std::vector<Vec3>& x);
double sum(std::span<const double> values);

/// Area vectors: a third of the facet vectors around each sample (outward, mm^2). The flux of a field F is
/// sum F(x_i) . a_i; the enclosed volume of the facets is a third of sum x_i . a_i.
std::vector<Vec3> area_vectors(const SampleLayout& layout, const std::vector<Vec3>& x);
/// Adjoint of area_vectors: adds to dE_dx what dE_da implies.
void pull_back_area_vectors(const SampleLayout& layout, const std::vector<Vec3>& x, const std::vector<Vec3>& dE_da,
                            std::vector<Vec3>& dE_dx);

/// Volume of the facets, mm^3.
double facet_volume(const SampleLayout& layout, const std::vector<Vec3>& x);

/// `rounds` times: each value becomes the mean of itself and its neighbours. NaN values are left out and filled in.
void average_over_mesh(const SampleGraph& graph, int rounds, std::vector<double>& values);

}  // namespace pellicle
