#include "pellicle/fit/stage_geometry.h"

#include <algorithm>
#include <cmath>

namespace pellicle {

StageGeometry::StageGeometry(const SurfaceModel& model, int level)
    : layout(layout_of(model, level)),
      graph(layout),
      coarser(layout_of(model, std::min(level, 2))),
      coarse(samples_of_coarser(layout, coarser)) {}

const VectorRows& StageGeometry::constant_rows(const EnergyKind& kind) const {
  const std::scoped_lock lock(mutex_);
  const auto at = constant_.find(&kind);
  if (at != constant_.end()) return at->second;
  if (!kind.coarse || coarse.empty()) return constant_.emplace(&kind, kind.constant(layout)).first->second;
  VectorRows rows = kind.constant(coarser);
  for (int& s : rows.sample) s = coarse[static_cast<std::size_t>(s)];
  return constant_.emplace(&kind, std::move(rows)).first->second;
}

const StageGeometry& GeometryCache::get(const SurfaceModel& model, int level) {
  Parameters reference = std::visit([](const auto& m) { return m.reference(); }, model);
  const Parameters somewhere = reference.empty() ? Parameters(3 * blocks_of(model).size()) : reference;
  std::vector<std::array<int, 3>> facets = control_mesh_of({model, somewhere}).triangles;
  const Key key{model.index(), level, std::move(facets), std::move(reference)};
  const std::scoped_lock lock(mutex_);
  auto at = cache_.find(key);
  if (at == cache_.end()) at = cache_.try_emplace(key, model, level).first;
  return at->second;
}

int sampling_level(const SurfaceModel& model, double area, double h, Density density) {
  const double most = density == Density::all    ? 9000.0
                      : density == Density::fine ? 4000.0
                                                 : std::max(500.0, 16.0 * control_point_count(model));
  const double h2_per_sample = density == Density::all ? 1.2 : 3.5;
  const double wanted = std::clamp(area / (h2_per_sample * h * h), 500.0, most);
  const double level = 0.5 * std::log2(2.0 * wanted / base_facets(model));
  return std::clamp(static_cast<int>(std::lround(level)), 1, 6);
}

}  // namespace pellicle
