#include "pellicle/raster/closed_solid.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "pellicle/base/errors.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/raster/mask_morphology.h"
#include "pellicle/raster/mask_part.h"
#include "pellicle/raster/rasterize.h"

namespace pellicle {

namespace {

using Mask = Image<std::uint8_t>;

/// Fills every gap that `steps` of growing close, and returns to size.
Mask closed(Mask mask, int steps) {
  grow_or_shrink(mask, steps, true);
  fill_cavities(mask);
  grow_or_shrink(mask, steps, false);
  keep_largest(mask);
  fill_cavities(mask);
  return mask;
}

int genus_of(const TriangleMesh& surface) {
  const MeshTopology t = topology_of(surface);
  return t.closed && t.manifold && t.components == 1 ? t.genus : 1000;
}

struct Candidate {
  Mask mask;
  TriangleMesh surface;
  double closing = 0.0, volume = 0.0;
  int genus = 0;
};

// Solids on finer and coarser grids, the widest gaps bridged first. One that lets water in loses most of its volume
// against the one before and is left out.
std::vector<Candidate> watertight_solids(const std::vector<Vec3>& points, const Vec3& lo, const Vec3& hi,
                                         double spacing) {
  constexpr double kKept = 0.7;
  const double extent = (hi - lo).maxCoeff();
  std::vector<std::pair<double, int>> grids;  // voxel size, steps of closing
  for (const double n : {100.0, 76.0, 58.0, 44.0, 34.0, 26.0, 20.0, 15.0, 11.0, 8.0}) {
    const double h = extent / n;
    if (h < 0.7 * spacing && n > 8.0) continue;
    grids.emplace_back(h, 1);
    grids.emplace_back(h, 2);
  }
  const auto closing = [](const auto& grid) { return (2.0 * grid.second + 1.0) * grid.first; };
  std::stable_sort(grids.begin(), grids.end(), [&](const auto& a, const auto& b) { return closing(a) > closing(b); });
  std::vector<Candidate> solids;
  for (const auto& grid : grids) {
    Candidate c;
    c.mask = closed(occupied_voxels(points, lo, hi, grid.first, grid.second + 2), grid.second);
    c.surface = surface_of_mask(c.mask);
    if (c.surface.triangles.empty()) continue;
    c.closing = closing(grid);
    c.volume = volume_of(c.surface);
    if (!solids.empty() && c.volume < kKept * solids.back().volume) continue;
    c.genus = genus_of(c.surface);
    if (c.genus < 1000) solids.push_back(std::move(c));
  }
  return solids;
}

}  // namespace

ClosedSolid solid_of_points(const std::vector<Vec3>& points, double spacing) {
  if (points.size() < 4) throw BadData("surface around points: at least four points are needed");
  Vec3 lo = points.front(), hi = lo;
  for (const Vec3& x : points) {
    lo = lo.cwiseMin(x);
    hi = hi.cwiseMax(x);
  }
  const double extent = (hi - lo).maxCoeff();
  if (!((hi - lo).minCoeff() > 1e-9 * extent)) throw BadData("surface around points: they all lie in one plane");
  std::vector<Candidate> solids = watertight_solids(points, lo, hi, spacing);
  for (auto c = solids.rbegin(); c != solids.rend(); ++c) {
    if (c->genus != 0) continue;
    Candidate& given = solids.back();
    return {std::move(c->surface), c->closing, given.genus, std::move(given.mask)};
  }
  // Sheets and dust: grown without shrinking.
  for (const double n : {24.0, 16.0, 10.0, 6.0, 4.0}) {
    Mask mask = occupied_voxels(points, lo, hi, extent / n, 4);
    grow_or_shrink(mask, 1, true);
    fill_cavities(mask);
    keep_largest(mask);
    ClosedSolid solid{surface_of_mask(mask), 3.0 * extent / n, 0, mask};
    if (genus_of(solid.surface) == 0) return solid;
  }
  throw BadData("surface around points: no closed surface of genus 0 could be laid around them");
}

void turn_out_of(const Mask& solid, const std::vector<Vec3>& points, std::vector<Vec3>& normals) {
  const ImageGrid& grid = solid.grid;
  const auto inside = [&](const Vec3& x) {
    Index3 at{};
    const Vec3 index = grid.index_from_world(x);
    for (int a = 0; a < 3; ++a) {
      const auto axis = static_cast<std::size_t>(a);
      at[axis] = static_cast<int>(std::lround(index[a]));
      if (at[axis] < 0 || at[axis] >= grid.size[axis]) return 0;
    }
    return static_cast<int>(solid.at(at[0], at[1], at[2]));
  };
  for (std::size_t k = 0; k < points.size(); ++k) {
    int behind = 0;
    for (int step = 1; step <= 3; ++step) {
      const Vec3 away = step * grid.mean_spacing() * normals[k];
      behind += inside(points[k] - away) - inside(points[k] + away);
    }
    normals[k] *= behind > 0 ? 1.0 : behind < 0 ? -1.0 : 0.0;
  }
}

ClosedSolid solid_of_mask(const Mask& mask) {
  std::optional<int> given;
  Mask given_mask;
  for (const int steps : {0, 1, 2, 4, 8, 16, 32}) {
    Mask part = closed(largest_part(mask, steps + 2), steps);
    ClosedSolid solid{surface_of_mask(part), 2.0 * steps * mask.grid.mean_spacing(), 0, {}};
    if (steps == 0) given_mask = std::move(part);
    const int genus = genus_of(solid.surface);
    if (!given) given = genus;
    solid.genus_as_given = *given < 1000 ? *given : 0;
    if (genus != 0) continue;
    solid.as_given = std::move(given_mask);
    return solid;
  }
  throw BadData("surface of the mask: no closed surface of genus 0 could be laid around it");
}

}  // namespace pellicle
