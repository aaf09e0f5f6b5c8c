#pragma once
/// What depends on the control mesh and the density of samples alone: built once, used by every stage and hypothesis.

#include <array>
#include <compare>
#include <map>
#include <mutex>
#include <vector>

#include "pellicle/energies/energy_kind.h"
#include "pellicle/energies/geometry.h"
#include "pellicle/energies/rows.h"
#include "pellicle/surface/surface.h"

namespace pellicle {

struct StageGeometry {
  SampleLayout layout;
  SampleGraph graph;
  SampleLayout coarser;  ///< about eight samples per control triangle
  /// Samples of `layout` at the places of those of `coarser`: enough for what is smooth anyway; empty (all) when a
  /// model's levels do not share their samples.
  std::vector<int> coarse;
  StageGeometry(const SurfaceModel& model, int level);

  /// Rows that are the same in every step (EnergyKind::constant), made when they are first asked for.
  const VectorRows& constant_rows(const EnergyKind& kind) const;

 private:
  mutable std::mutex mutex_;
  mutable std::map<const EnergyKind*, VectorRows> constant_;
};

/// Geometries by control mesh, reference shape and level. One subdivision rule per cache. Threads may share it.
class GeometryCache {
 public:
  const StageGeometry& get(const SurfaceModel& model, int level);

 private:
  struct Key {
    std::size_t kind;  ///< alternative of SurfaceModel
    int level;
    std::vector<std::array<int, 3>> control_facets;
    Parameters reference;
    auto operator<=>(const Key&) const = default;
  };
  std::mutex mutex_;
  std::map<Key, StageGeometry> cache_;
};

/// How densely a surface is sampled: coarse is enough to place control points, fine to measure edges, all is about one
/// sample per voxel along the surface.
enum class Density { coarse, fine, all };
/// Level at which a surface has about one sample per 3.5 h^2 (`all`: 1.2 h^2); at least 500, at most 16 per control
/// point (`fine`: 4000, `all`: 9000).
int sampling_level(const SurfaceModel& model, double area, double h, Density density);

}  // namespace pellicle
