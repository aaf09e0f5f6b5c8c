#include "pellicle/seed/voxel_seed.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "pellicle/base/errors.h"
#include "pellicle/mask/limb_growth.h"
#include "pellicle/mask/morphology.h"
#include "pellicle/mask/parts.h"

namespace pellicle {
namespace {

void check_spacing(double spacing_mm) {
  if (std::isfinite(spacing_mm) && spacing_mm > 0) return;
  throw UsageError(fmt::format("spacing of the voxel seed ({}): must be above 0 mm", spacing_mm));
}

struct Box {
  Vec3 lo = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 hi = Vec3::Constant(-std::numeric_limits<double>::infinity());
  void add(const Vec3& x) {
    lo = lo.cwiseMin(x);
    hi = hi.cwiseMax(x);
  }
};

Box box_of(const std::vector<Vec3>& points) {
  if (points.empty()) throw BadData("voxel seed (all): there are no points");
  Box box;
  for (const Vec3& x : points) box.add(x);
  if (!box.lo.allFinite() || !box.hi.allFinite()) throw BadData("voxel seed (points): a coordinate is not finite");
  return box;
}

/// Outermost faces of the voxels inside, in index coordinates.
Box box_of(const Image<std::uint8_t>& mask) {
  Box box;
  const Index3& n = mask.grid.size;
  for (int k = 0; k < n[2]; ++k) {
    for (int j = 0; j < n[1]; ++j) {
      for (int i = 0; i < n[0]; ++i) {
        if (mask.at(i, j, k) == 0) continue;
        box.add(Vec3(i - 0.5, j - 0.5, k - 0.5));
        box.add(Vec3(i + 0.5, j + 0.5, k + 0.5));
      }
    }
  }
  if (!box.lo.allFinite()) throw BadData("voxel seed (all): the mask is empty");
  return box;
}

/// More voxels than any seed needs: a spacing that does not fit the size.
constexpr double kMostVoxels = 1e8;

ImageGrid grid_over(const Vec3& first_centre, const Vec3& extent, double spacing_mm) {
  ImageGrid grid;
  const Vec3 count = (extent / spacing_mm).array().ceil();
  if (!(count.prod() <= kMostVoxels)) {
    throw UsageError(fmt::format("spacing of the voxel seed ({} mm): the object would have {:.0e} voxels", spacing_mm,
                                 count.prod()));
  }
  for (int a = 0; a < 3; ++a) grid.size[static_cast<std::size_t>(a)] = std::max(1, static_cast<int>(count[a]));
  grid.spacing = Vec3::Constant(spacing_mm);
  grid.origin_in_world = first_centre;
  return grid;
}

}  // namespace

double coarsest_spacing(const std::vector<Vec3>& points) {
  const Box box = box_of(points);
  const double edge = (box.hi - box.lo).minCoeff();
  if (!(edge > 0)) throw BadData("voxel seed (points): they lie in a plane");
  return edge / 3;
}

double coarsest_spacing(const Image<std::uint8_t>& mask) {
  const Box box = box_of(mask);
  return (box.hi - box.lo).cwiseProduct(mask.grid.spacing).minCoeff() / 3;
}

Image<std::uint8_t> voxels_of_points(const std::vector<Vec3>& points, double spacing_mm) {
  check_spacing(spacing_mm);
  const Box box = box_of(points);
  constexpr int kPad = 3;
  Image<std::uint8_t> marked(grid_over(box.lo + Vec3::Constant((0.5 - kPad) * spacing_mm),
                                       box.hi - box.lo + Vec3::Constant((2 * kPad + 1) * spacing_mm), spacing_mm));
  for (const Vec3& x : points) {
    const Vec3 at = ((x - box.lo) / spacing_mm).array().floor();
    marked.at(static_cast<int>(at.x()) + kPad, static_cast<int>(at.y()) + kPad, static_cast<int>(at.z()) + kPad) = 1;
  }
  grow(marked, 1);
  return shrunk_by_faces(marked);
}

Image<std::uint8_t> voxels_of_mask(const Image<std::uint8_t>& mask, double spacing_mm, double fraction, Limbs limbs) {
  constexpr double kHeld = 0.2;  // fraction of an octant that makes it part of the object
  check_spacing(spacing_mm);
  const Box box = box_of(mask);
  const Vec3 step = mask.grid.spacing.cwiseInverse() * spacing_mm;  // in the mask's voxels
  const Vec3 extent = (box.hi - box.lo).cwiseProduct(mask.grid.spacing);
  ImageGrid grid = grid_over(Vec3::Zero(), extent, spacing_mm);
  Vec3 first;  // the object in the middle of the grid
  Index3 parts{};
  for (int a = 0; a < 3; ++a) {
    const auto axis = static_cast<std::size_t>(a);
    first[a] = (box.lo[a] + box.hi[a] - (grid.size[axis] - 1) * step[a]) / 2;
    parts[axis] = 2 * std::clamp(static_cast<int>(std::ceil(step[a])), 1, 3);
  }
  grid.direction = mask.grid.direction;
  grid.origin_in_world = mask.grid.world_from_index(first);
  Image<std::uint8_t> voxels(grid), octants(grid);
  const auto inside_at = [&](const Vec3& index) {
    const Vec3 nearest = (index.array() + 0.5).floor();
    const Index3 v{static_cast<int>(nearest.x()), static_cast<int>(nearest.y()), static_cast<int>(nearest.z())};
    for (std::size_t a = 0; a < 3; ++a) {
      if (v[a] < 0 || v[a] >= mask.grid.size[a]) return false;
    }
    return mask.at(v[0], v[1], v[2]) != 0;
  };
  const int all = parts[0] * parts[1] * parts[2];
  for (int k = 0; k < grid.size[2]; ++k) {
    for (int j = 0; j < grid.size[1]; ++j) {
      for (int i = 0; i < grid.size[0]; ++i) {
        int inside = 0;
        std::array<int, 8> in_octant{};
        for (int p = 0; p < all; ++p) {
          const Index3 at{p % parts[0], p / parts[0] % parts[1], p / (parts[0] * parts[1])};
          const Vec3 offset =
              (Vec3(at[0], at[1], at[2]).array() + 0.5) / Vec3(parts[0], parts[1], parts[2]).array() - 0.5;
          if (!inside_at(first + step.cwiseProduct(Vec3(i, j, k) + offset))) continue;
          ++inside;
          ++in_octant[(offset.x() > 0 ? 1U : 0U) + (offset.y() > 0 ? 2U : 0U) + (offset.z() > 0 ? 4U : 0U)];
        }
        for (unsigned o = 0; o < 8; ++o) {
          if (in_octant[o] >= kHeld * all / 8) octants.at(i, j, k) |= static_cast<std::uint8_t>(1U << o);
        }
        voxels.at(i, j, k) = inside > 0 && inside >= fraction * all ? 1 : 0;
      }
    }
  }
  if (limbs == Limbs::followed) {
    keep_largest_part(voxels);
    grow_along_limbs(voxels, octants);
  }
  return voxels;
}

VoxelSeed voxel_seed_of_voxels(Image<std::uint8_t> voxels) {
  VoxelSeed seed;
  seed.spacing_mm = voxels.grid.mean_spacing();
  seed.filled = make_manifold(voxels);
  seed.mesh = boundary_of_voxels(voxels);
  seed.genus = quad_topology(static_cast<int>(seed.mesh.vertices.size()), seed.mesh.quads).genus;
  return seed;
}

VoxelSeed voxel_seed_of_mask(const Image<std::uint8_t>& mask, std::optional<double> spacing_mm, double fraction) {
  if (spacing_mm) return voxel_seed_of_voxels(voxels_of_mask(mask, *spacing_mm, fraction));
  const double coarsest = coarsest_spacing(mask);
  constexpr int kMost = 7;  // grids: down to a twenty-fourth of the smallest edge
  std::vector<VoxelSeed> seeds;
  for (int step = 0; step < kMost; ++step) {
    const double spacing = coarsest * std::pow(0.5, 0.5 * step);
    if (!seeds.empty() && spacing < mask.grid.spacing.maxCoeff()) break;
    Image<std::uint8_t> voxels = voxels_of_mask(mask, spacing, fraction);
    const bool empty = std::all_of(voxels.voxels.begin(), voxels.voxels.end(), [](std::uint8_t v) { return v == 0; });
    if (!empty) seeds.push_back(voxel_seed_of_voxels(std::move(voxels)));
  }
  if (seeds.empty()) {
    throw BadData("voxel seed (mask): it is thinner than its voxels everywhere; give a finer spacing");
  }
  std::size_t best = 0, longest = 0;
  for (std::size_t first = 0; first < seeds.size();) {
    std::size_t end = first;
    while (end < seeds.size() && seeds[end].genus == seeds[first].genus) ++end;
    if (end - first > longest) {  // of equally long runs the coarser one
      longest = end - first;
      best = first;
    }
    first = end;
  }
  return seeds[best];
}

VoxelSeed voxel_seed_of_points(const std::vector<Vec3>& points, std::optional<double> spacing_mm) {
  const double spacing = spacing_mm.value_or(coarsest_spacing(points));
  return voxel_seed_of_voxels(voxels_of_points(points, spacing));
}

}  // namespace pellicle
