#include "pellicle/raster/closed_solid.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "pellicle/base/errors.h"
#include "pellicle/mask/limb_growth.h"
#include "pellicle/mask/morphology.h"
#include "pellicle/mask/parts.h"
#include "pellicle/mesh/distance.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/mesh/points/point_tree.h"
#include "pellicle/raster/internal/gauss_field.h"
#include "pellicle/raster/internal/occupied_voxels.h"
#include "pellicle/raster/rasterize.h"

namespace pellicle {

namespace {

using Mask = Image<std::uint8_t>;

/// Morphological closing by cubes of `steps` voxels each way, cavities filled, largest part.
Mask closed(Mask mask, int steps) {
  grow(mask, steps);
  fill_cavities(mask);
  shrink(mask, steps);
  keep_largest_part(mask);
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

// Solids on finer and coarser grids, the widest gaps bridged first. A solid that has lost much of the volume of the one
// before has a leak and is left out.
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

// One point per voxel, of the finest voxels that leave so few.
std::vector<Vec3> evenly_thinned(const std::vector<Vec3>& points, const Vec3& lo, const Vec3& hi, std::size_t most) {
  if (points.size() <= most) return points;
  for (double h = (hi - lo).maxCoeff() / 100.0;; h *= 1.1) {
    Mask taken = occupied_voxels({}, lo, hi, h, 1);
    std::vector<Vec3> out;
    for (const Vec3& x : points) {
      const Vec3 at = taken.grid.index_from_world(x);
      std::uint8_t& voxel = taken.at(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())),
                                     static_cast<int>(std::lround(at.z())));
      if (voxel == 0) out.push_back(x);
      voxel = 1;
    }
    if (out.size() <= most) return out;
  }
}

// Distance between points and surface: the sum of the means in both directions, and twice the widest gap.
struct Misfit {
  double mean = 0.0, gap = 0.0;
};
Misfit misfit_of(const TriangleMesh& surface, const PointTree& points) {
  const ClosestPoint to_surface(surface);
  const auto mean_of = [](const std::vector<Vec3>& places, const auto& distance) {
    double total = 0.0;
    for (const Vec3& x : places) total += distance(x);
    return total / static_cast<double>(places.size());
  };
  Misfit misfit;
  misfit.mean = mean_of(points.points(), [&](const Vec3& x) { return to_surface.query(x).distance; });
  misfit.mean += mean_of(sample_surface(surface, 3000), [&](const Vec3& x) {
    const double d = points.nearest(x, 1).front().distance;
    misfit.gap = std::max(misfit.gap, 2.0 * d);
    return d;
  });
  return misfit;
}

// Weights 1, 2, 1 along each axis: details narrower than the distance of neighbouring points are due to chance.
void smooth(Image<float>& field) {
  const Index3& size = field.grid.size;
  std::size_t step = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto n = static_cast<std::size_t>(size[a]);
    const std::vector<float> from = field.voxels;
    for (std::size_t at = 0; at < from.size(); ++at) {
      const std::size_t along = at / step % n;
      const float before = along > 0 ? from[at - step] : from[at], after = along + 1 < n ? from[at + step] : from[at];
      field.voxels[at] = 0.25F * before + 0.5F * from[at] + 0.25F * after;
    }
    step *= n;
  }
}

// Strings of points that lie off the surface, each with one that is far off, as voxels along them: limbs too thin for
// the field.
Image<std::uint8_t> limbs_beyond(const TriangleMesh& surface, const PointTree& points, const ImageGrid& grid) {
  constexpr double kOff = 0.75, kFar = 2.0, kLink = 3.0;  // voxels
  constexpr double kUsuallyOff = 3.0, kUsuallyFar = 6.0;  // medians of all distances: noise is not a limb
  constexpr int kNeighbours = 8;
  constexpr std::size_t kLeast = 3;
  constexpr std::uint8_t kAll = 0xFF;  // octants
  const double h = grid.spacing[0];
  const ClosestPoint to_surface(surface);
  std::vector<double> distance;
  for (const Vec3& x : points.points()) distance.push_back(to_surface.query(x).distance);
  std::vector<double> sorted = distance;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
  const double usual = sorted[sorted.size() / 2], off = std::max(kOff * h, kUsuallyOff * usual),
               far = std::max(kFar * h, kUsuallyFar * usual);
  Image<std::uint8_t> limbs(grid);
  const auto mark = [&](const Vec3& x) {
    const Vec3 at = grid.index_from_world(x);
    limbs.at(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())),
             static_cast<int>(std::lround(at.z()))) = kAll;
  };
  std::vector<bool> seen(distance.size(), false);
  for (std::size_t tip = 0; tip < distance.size(); ++tip) {
    if (seen[tip] || distance[tip] < far) continue;
    std::vector<std::size_t> open{tip};
    std::vector<std::pair<Vec3, Vec3>> links;
    seen[tip] = true;
    while (!open.empty()) {
      const Vec3 x = points.points()[open.back()];
      open.pop_back();
      for (const auto& next : points.nearest(x, kNeighbours)) {
        const auto n = static_cast<std::size_t>(next.point);
        if (seen[n] || distance[n] < off || next.distance > kLink * h) continue;
        seen[n] = true;
        open.push_back(n);
        links.emplace_back(x, points.points()[n]);
      }
    }
    if (links.size() + 1 < kLeast) continue;
    for (const auto& [from, to] : links) {
      const int steps = 1 + static_cast<int>(2.0 * (to - from).norm() / h);
      for (int k = 0; k <= steps; ++k) mark(from + (to - from) * k / steps);
    }
  }
  return limbs;
}

void add_limbs(Candidate& c, const PointTree& points) {
  const Image<std::uint8_t> limbs = limbs_beyond(c.surface, points, c.mask.grid);
  if (std::all_of(limbs.voxels.begin(), limbs.voxels.end(), [](std::uint8_t v) { return v == 0; })) return;
  Candidate with = c;
  grow_along_limbs(with.mask, limbs);
  with.surface = surface_of_mask(with.mask);
  if (genus_of(with.surface) == c.genus) c = std::move(with);
}

// The field above one half. Of none, one or two smoothings the first with the fewest handles: smoothing removes chance.
std::optional<Candidate> gauss_candidate(const PointTree& points, const Vec3& lo, const Vec3& hi) {
  constexpr double kMostVoxels = 72.0;  // along the longest edge
  constexpr std::size_t kLeastPart = 8;
  const double spacing = point_spacing(points);
  const double h = std::max(spacing, (hi - lo).maxCoeff() / kMostVoxels);
  Image<float> field = gauss_field(points.points(), spacing, occupied_voxels({}, lo, hi, h, 3).grid);
  std::optional<Candidate> best;
  for (int pass = 0; pass < 3; ++pass) {
    if (pass > 0) smooth(field);
    Candidate c;
    c.mask = Mask(field.grid);
    std::transform(field.voxels.begin(), field.voxels.end(), c.mask.voxels.begin(),
                   [](float value) { return static_cast<std::uint8_t>(value > 0.5F ? 1 : 0); });
    join_parts(c.mask, field, kLeastPart);  // limbs hang by less than a voxel in places
    fill_cavities(c.mask);
    c.surface = surface_of_mask(c.mask);
    if (c.surface.triangles.empty()) continue;
    c.genus = genus_of(c.surface);
    if (c.genus < (best ? best->genus : 1000)) best = std::move(c);
  }
  if (best) add_limbs(*best, points);
  return best;
}

// The solid without a leak that bridges the narrowest gap, or that of Gauss's formula if it is nearer to the points.
std::optional<Candidate> nearest_solid(const std::vector<Vec3>& points, const Vec3& lo, const Vec3& hi,
                                       const std::vector<Candidate>& watertight) {
  constexpr std::size_t kMost = 2000;
  const PointTree some(evenly_thinned(points, lo, hi, kMost));
  std::optional<Candidate> gauss = gauss_candidate(some, lo, hi);
  if (!gauss) return watertight.empty() ? std::nullopt : std::optional(watertight.back());
  const Misfit misfit = misfit_of(gauss->surface, some);
  gauss->closing = misfit.gap;
  if (watertight.empty() || misfit.mean < misfit_of(watertight.back().surface, some).mean) return gauss;
  return watertight.back();
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
  if (std::optional<Candidate> given = nearest_solid(points, lo, hi, solids)) solids.push_back(std::move(*given));
  for (auto c = solids.rbegin(); c != solids.rend(); ++c) {
    if (c->genus != 0) continue;
    Candidate& given = solids.back();
    return {std::move(c->surface), c->closing, given.genus, std::move(given.mask)};
  }
  // Open sheets and sparse points: dilated without erosion.
  for (const double n : {24.0, 16.0, 10.0, 6.0, 4.0}) {
    Mask mask = occupied_voxels(points, lo, hi, extent / n, 4);
    grow(mask, 1);
    fill_cavities(mask);
    keep_largest_part(mask);
    ClosedSolid solid{surface_of_mask(mask), 3.0 * extent / n, 0, mask};
    if (genus_of(solid.surface) == 0) return solid;
  }
  throw BadData("surface around points: no closed surface of genus 0 could be laid around them");
}

void orient_outward(const Mask& solid, const std::vector<Vec3>& points, std::vector<Vec3>& normals) {
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
