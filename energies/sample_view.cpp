#include "pellicle/energies/sample_view.h"

#include <algorithm>
#include <utility>

#include "pellicle/surface/surface.h"

namespace pellicle {

namespace {

SurfaceSamples samples_of(const Surface& surface, const SampleLayout& layout) {
  SurfaceSamples samples;
  evaluate(surface.model, surface.parameters, layout, false, samples);
  return samples;
}

}  // namespace

double SampleView::coarse_area() const {
  if (coarse.empty()) return total_area;
  double sum = 0.0;
  for (const int i : coarse) sum += area[static_cast<std::size_t>(i)];
  return sum;
}

SampledSurface::SampledSurface(const SampleLayout& layout, SurfaceSamples samples, const SampleGraph* graph,
                               std::span<const int> coarse)
    : layout_(&layout),
      graph_(graph),
      coarse_(coarse),
      samples_(std::move(samples)),
      area_(sample_areas(layout, samples_.x)),
      total_area_(sum(area_)),
      volume_(facet_volume(layout, samples_.x)) {}

SampledSurface::SampledSurface(const SampleLayout& layout, const Surface& surface, const SampleGraph* graph,
                               std::span<const int> coarse)
    : SampledSurface(layout, samples_of(surface, layout), graph, coarse) {}

TriangleMesh mesh_of(const SampleView& surface) {
  return {
      {surface.x.begin(), surface.x.end()}, surface.layout.triangles, {surface.normal.begin(), surface.normal.end()}};
}

std::vector<double> sum_of_curvatures(const SampleView& surface) {
  const auto at = [](int i) { return static_cast<std::size_t>(i); };
  const std::span<const Vec3> x = surface.x;
  std::vector<Vec3> laplacian(x.size(), Vec3::Zero());
  for (const auto& t : surface.layout.triangles) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t i = at(t[c]), j = at(t[(c + 1) % 3]), k = at(t[(c + 2) % 3]);
      const Vec3 u = x[i] - x[k], v = x[j] - x[k];
      const double cotangent = u.dot(v) / std::max(u.cross(v).norm(), 1e-12 * (u.squaredNorm() + v.squaredNorm()));
      const Vec3 pull = 0.5 * std::clamp(cotangent, -10.0, 10.0) * (x[j] - x[i]);
      laplacian[i] += pull;
      laplacian[j] -= pull;
    }
  }
  std::vector<double> curvature(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double area = surface.area[i];
    curvature[i] = area > 0 ? -laplacian[i].dot(surface.normal[i]) / area : 0.0;
  }
  return curvature;
}

}  // namespace pellicle
