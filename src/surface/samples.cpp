#include "pellicle/surface/samples.h"

#include <algorithm>

#include "pellicle/mesh/points/point_tree.h"

namespace pellicle {

TriangleMesh mesh_of(const SampleLayout& layout, const SurfaceSamples& samples) {
  return {samples.x, layout.triangles, samples.normal};
}

std::vector<int> samples_of_coarser(const SampleLayout& layout, const SampleLayout& coarser) {
  constexpr double kSamePlace = 1e-9;  // of the size of the reference shape
  const PointTree places(layout.reference);
  std::vector<int> samples;
  samples.reserve(coarser.reference.size());
  double apart = 0.0, size = 0.0;
  for (const Vec3& place : coarser.reference) {
    const PointTree::Neighbour nearest = places.nearest(place, 1).front();
    apart = std::max(apart, nearest.distance);
    size = std::max(size, place.norm());
    samples.push_back(nearest.point);
  }
  if (apart > kSamePlace * size) return {};
  return samples;
}

}  // namespace pellicle
