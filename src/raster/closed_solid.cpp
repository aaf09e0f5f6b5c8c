#include "pellicle/raster/closed_solid.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "pellicle/base/errors.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/raster/rasterize.h"

namespace pellicle {

namespace {

using Mask = Image<std::uint8_t>;

// Largest (grow) or smallest value within one voxel along one index axis; beyond the border counts as 0.
void pass(Mask& mask, int axis, bool grow) {
  const Index3& size = mask.grid.size;
  const auto a = static_cast<std::size_t>(axis);
  const std::size_t stride = axis == 0   ? 1
                             : axis == 1 ? static_cast<std::size_t>(size[0])
                                         : static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]);
  const auto n = static_cast<std::size_t>(size[a]);
  std::vector<std::uint8_t> line(n + 2, 0);
  for (std::size_t start = 0; start < mask.voxels.size(); ++start) {
    if ((start / stride) % n != 0) continue;
    for (std::size_t i = 0; i < n; ++i) line[i + 1] = mask.voxels[start + i * stride];
    for (std::size_t i = 0; i < n; ++i) {
      mask.voxels[start + i * stride] =
          grow ? std::max({line[i], line[i + 1], line[i + 2]}) : std::min({line[i], line[i + 1], line[i + 2]});
    }
  }
}

void grow_or_shrink(Mask& mask, int steps, bool grow) {
  for (int s = 0; s < steps; ++s) {
    for (int axis = 0; axis < 3; ++axis) pass(mask, axis, grow);
  }
}

// Voxels that hang together by faces with `seed` and have the same value get `mark`; returns how many.
std::size_t flood(Mask& mask, std::size_t seed, std::uint8_t mark) {
  const Index3& size = mask.grid.size;
  const std::size_t nx = static_cast<std::size_t>(size[0]), ny = static_cast<std::size_t>(size[1]),
                    nz = static_cast<std::size_t>(size[2]);
  const std::uint8_t from = mask.voxels[seed];
  std::vector<std::size_t> open{seed};
  mask.voxels[seed] = mark;
  std::size_t count = 0;
  const auto visit = [&](bool there, std::size_t at) {
    if (!there || mask.voxels[at] != from) return;
    mask.voxels[at] = mark;
    open.push_back(at);
  };
  while (!open.empty()) {
    const std::size_t at = open.back();
    open.pop_back();
    ++count;
    const std::size_t x = at % nx, y = at / nx % ny, z = at / (nx * ny);
    visit(x > 0, at - 1);
    visit(x + 1 < nx, at + 1);
    visit(y > 0, at - nx);
    visit(y + 1 < ny, at + nx);
    visit(z > 0, at - nx * ny);
    visit(z + 1 < nz, at + nx * ny);
  }
  return count;
}

// \pre the border is empty.
void fill_cavities(Mask& mask) {
  flood(mask, 0, 2);
  for (auto& v : mask.voxels) v = v == 2 ? 0 : 1;
}

// Keeps the largest part only; returns its voxels.
std::size_t keep_largest(Mask& mask) {
  std::size_t most = 0, where = 0;
  for (std::size_t i = 0; i < mask.voxels.size(); ++i) {
    if (mask.voxels[i] != 1) continue;
    const std::size_t count = flood(mask, i, 2);
    if (count > most) {
      most = count;
      where = i;
    }
  }
  if (most > 0) flood(mask, where, 1);
  for (auto& v : mask.voxels) v = v == 1 ? 1 : 0;
  return most;
}

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

Mask occupied(const std::vector<Vec3>& points, const Vec3& lo, const Vec3& hi, double h, int margin) {
  ImageGrid grid;
  grid.spacing = Vec3::Constant(h);
  for (int a = 0; a < 3; ++a) {
    grid.size[static_cast<std::size_t>(a)] = static_cast<int>(std::ceil((hi[a] - lo[a]) / h)) + 1 + 2 * margin;
  }
  grid.origin_in_world = lo - Vec3::Constant(margin * h);
  Mask mask(grid);
  for (const Vec3& x : points) {
    const Vec3 i = (x - grid.origin_in_world) / h;
    mask.at(static_cast<int>(std::lround(i.x())), static_cast<int>(std::lround(i.y())),
            static_cast<int>(std::lround(i.z()))) = 1;
  }
  return mask;
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
    c.mask = closed(occupied(points, lo, hi, grid.first, grid.second + 2), grid.second);
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
    Mask mask = occupied(points, lo, hi, extent / n, 4);
    grow_or_shrink(mask, 1, true);
    fill_cavities(mask);
    keep_largest(mask);
    ClosedSolid solid{surface_of_mask(mask), 3.0 * extent / n, 0, mask};
    if (genus_of(solid.surface) == 0) return solid;
  }
  throw BadData("surface around points: no closed surface of genus 0 could be laid around them");
}

ClosedSolid solid_of_mask(const Mask& mask) {
  const Index3& size = mask.grid.size;
  Index3 lo = size, hi{-1, -1, -1};
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i) {
        if (mask.at(i, j, k) == 0) continue;
        const Index3 at{i, j, k};
        for (std::size_t a = 0; a < 3; ++a) {
          lo[a] = std::min(lo[a], at[a]);
          hi[a] = std::max(hi[a], at[a]);
        }
      }
    }
  }
  if (hi[0] < 0) throw BadData("the mask is empty");
  std::optional<int> given;
  Mask given_mask;
  for (const int steps : {0, 1, 2, 4, 8, 16, 32}) {
    const int margin = steps + 2;
    ImageGrid grid = mask.grid;
    for (std::size_t a = 0; a < 3; ++a) grid.size[a] = hi[a] - lo[a] + 1 + 2 * margin;
    grid.origin_in_world = mask.grid.world_from_index(Vec3(lo[0] - margin, lo[1] - margin, lo[2] - margin));
    Mask part(grid);
    for (int k = lo[2]; k <= hi[2]; ++k) {
      for (int j = lo[1]; j <= hi[1]; ++j) {
        for (int i = lo[0]; i <= hi[0]; ++i) {
          part.at(i - lo[0] + margin, j - lo[1] + margin, k - lo[2] + margin) = mask.at(i, j, k) != 0 ? 1 : 0;
        }
      }
    }
    keep_largest(part);
    part = closed(std::move(part), steps);
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
