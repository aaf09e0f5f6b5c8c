#pragma once
/// A surface as an energy sees it at one moment: sample points with normals and areas over a mesh, never control
/// points.

#include <span>
#include <vector>

#include "pellicle/energies/geometry.h"
#include "pellicle/surface/samples.h"

namespace pellicle {

struct Surface;

/// Refers to what a SampledSurface holds. Only what needs cells of three corners reads `layout.triangles`.
struct SampleView {
  const SampleLayout& layout;
  const SampleGraph* graph = nullptr;  ///< neighbours of each sample; null where nobody asks for them
  /// Samples that a coarser level of the same control mesh has too: enough for what is smooth anyway; empty: all.
  std::span<const int> coarse = {};
  std::span<const Vec3> x = {};       ///< LPS mm
  std::span<const Vec3> normal = {};  ///< outward unit normals
  std::span<const double> area = {};  ///< one per sample, mm^2: a third of the facets around it
  double total_area = 0.0;            ///< mm^2
  double volume = 0.0;                ///< mm^3 within the facets of a closed surface

  std::size_t size() const { return x.size(); }
  /// Samples that a sum over the coarser level runs over.
  std::size_t coarse_size() const { return coarse.empty() ? x.size() : coarse.size(); }
  std::size_t coarse_sample(std::size_t k) const { return coarse.empty() ? k : static_cast<std::size_t>(coarse[k]); }
  /// mm^2, of the samples of the coarser level.
  double coarse_area() const;
};

/// The samples of a surface with their areas; what a SampleView refers to. Layout and graph must outlive it.
class SampledSurface {
 public:
  SampledSurface(const SampleLayout& layout, SurfaceSamples samples, const SampleGraph* graph = nullptr,
                 std::span<const int> coarse = {});
  SampledSurface(const SampleLayout& layout, const Surface& surface, const SampleGraph* graph = nullptr,
                 std::span<const int> coarse = {});
  SampledSurface(SampledSurface&&) = default;
  SampledSurface& operator=(SampledSurface&&) = default;
  SampledSurface(const SampledSurface&) = delete;
  SampledSurface& operator=(const SampledSurface&) = delete;
  ~SampledSurface() = default;

  const std::vector<Vec3>& x() const { return samples_.x; }
  const std::vector<Vec3>& normal() const { return samples_.normal; }
  const std::vector<double>& area() const { return area_; }
  double total_area() const { return total_area_; }
  double volume() const { return volume_; }
  SampleView view() const {
    return {*layout_, graph_, coarse_, samples_.x, samples_.normal, area_, total_area_, volume_};
  }
  operator SampleView() const { return view(); }  // NOLINT(google-explicit-constructor): energies take the view

 private:
  const SampleLayout* layout_;
  const SampleGraph* graph_;
  std::span<const int> coarse_;
  SurfaceSamples samples_;
  std::vector<double> area_;
  double total_area_, volume_;
};

/// The facets with normals.
TriangleMesh mesh_of(const SampleView& surface);

/// k1 + k2 (1/mm, positive where convex) by the cotangent Laplacian (Pinkall, Polthier 1993).
std::vector<double> sum_of_curvatures(const SampleView& surface);

}  // namespace pellicle
