#include "pellicle/raster/joint_labels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_map>

#include "pellicle/base/parallel.h"
#include "pellicle/mesh/distance.h"
#include "pellicle/mesh/measure.h"
#include "pellicle/raster/rasterize.h"
#include "pellicle/raster/voxel_box.h"

namespace pellicle {

namespace {

/// Calls body(offset in the grid) for the voxels that a piece holds.
template <class F>
void for_each_inside(const MaskPiece& piece, const ImageGrid& grid, const F& body) {
  const Index3& size = piece.mask.grid.size;
  std::size_t inner = 0;
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      std::size_t outer = grid.offset(piece.first[0], piece.first[1] + j, piece.first[2] + k);
      for (int i = 0; i < size[0]; ++i, ++inner, ++outer) {
        if (piece.mask.voxels[inner] != 0) body(outer);
      }
    }
  }
}

/// Voxels with several claims and, per surface, which of them it claims.
struct Disputes {
  std::vector<std::size_t> voxels;
  std::vector<std::vector<std::size_t>> of_surface;  ///< indices into `voxels`
};

Disputes disputes_of(const std::vector<MaskPiece>& pieces, const Image<std::uint16_t>& labels,
                     const std::vector<std::uint16_t>& own) {
  Disputes disputes;
  std::unordered_map<std::size_t, std::size_t> places;
  // A surface that holds a voxel with another label disputes it; the owner of that label is added afterwards.
  for (std::size_t s = 0; s < pieces.size(); ++s) {
    for_each_inside(pieces[s], labels.grid, [&](std::size_t voxel) {
      if (labels.voxels[voxel] != own[s] && places.try_emplace(voxel, disputes.voxels.size()).second) {
        disputes.voxels.push_back(voxel);
      }
    });
  }
  disputes.of_surface.resize(pieces.size());
  if (places.empty()) return disputes;
  for (std::size_t s = 0; s < pieces.size(); ++s) {
    for_each_inside(pieces[s], labels.grid, [&](std::size_t voxel) {
      const auto at = places.find(voxel);
      if (at != places.end()) disputes.of_surface[s].push_back(at->second);
    });
  }
  return disputes;
}

Vec3 centre_of(const ImageGrid& grid, std::size_t voxel) {
  const auto nx = static_cast<std::size_t>(grid.size[0]), ny = static_cast<std::size_t>(grid.size[1]);
  const std::size_t row = voxel / nx, slice = row / ny;
  return grid.world_from_index(
      Vec3(static_cast<double>(voxel % nx), static_cast<double>(row % ny), static_cast<double>(slice)));
}

}  // namespace

MaskPiece rasterize_piece(const TriangleMesh& surface, const ImageGrid& grid) {
  const VoxelBox box = box_around(surface, grid, 0);
  MaskPiece piece;
  piece.first = box.first;
  piece.mask.grid = box.grid;
  if (!box.empty()) piece.mask = rasterize_mask(surface, box.grid);
  for (const std::uint8_t v : piece.mask.voxels) piece.count += v;
  return piece;
}

std::size_t shared_voxels(const MaskPiece& a, const MaskPiece& b) {
  std::array<int, 3> from{}, to{};
  for (std::size_t x = 0; x < 3; ++x) {
    from[x] = std::max(a.first[x], b.first[x]);
    to[x] = std::min(a.first[x] + a.mask.grid.size[x], b.first[x] + b.mask.grid.size[x]);
  }
  std::size_t shared = 0;
  for (int k = from[2]; k < to[2]; ++k) {
    for (int j = from[1]; j < to[1]; ++j) {
      for (int i = from[0]; i < to[0]; ++i) {
        const bool both = a.mask.at(i - a.first[0], j - a.first[1], k - a.first[2]) != 0 &&
                          b.mask.at(i - b.first[0], j - b.first[1], k - b.first[2]) != 0;
        shared += both ? 1 : 0;
      }
    }
  }
  return shared;
}

JointLabels label_together(const std::vector<const TriangleMesh*>& surfaces, const std::vector<std::uint16_t>& labels,
                           const ImageGrid& grid) {
  JointLabels out{Image<std::uint16_t>(grid), std::vector<std::size_t>(surfaces.size(), 0),
                  std::vector<std::size_t>(surfaces.size(), 0)};
  std::vector<MaskPiece> pieces(surfaces.size());
  parallel_for(surfaces.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) pieces[s] = rasterize_piece(*surfaces[s], grid);
  });
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    for_each_inside(pieces[s], grid, [&](std::size_t voxel) {
      if (out.labels.voxels[voxel] == 0) out.labels.voxels[voxel] = labels[s];
    });
    out.voxels[s] = pieces[s].count;
  }
  const Disputes disputes = disputes_of(pieces, out.labels, labels);
  std::vector<std::vector<double>> depth(surfaces.size());
  parallel_for(surfaces.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const auto& own = disputes.of_surface[s];
      if (own.empty()) continue;
      const ClosestPoint closest(*surfaces[s]);
      const double size = std::cbrt(3.0 * std::abs(volume_of(*surfaces[s])) / (4.0 * std::numbers::pi));
      depth[s].reserve(own.size());
      for (const std::size_t d : own) {
        depth[s].push_back(closest.query(centre_of(grid, disputes.voxels[d])).distance / size);
      }
    }
  });
  constexpr std::size_t nobody = std::numeric_limits<std::size_t>::max();
  std::vector<double> deepest(disputes.voxels.size(), -1.0);
  std::vector<std::size_t> winner(disputes.voxels.size(), nobody);
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    out.shared[s] = disputes.of_surface[s].size();
    out.voxels[s] -= disputes.of_surface[s].size();
    for (std::size_t n = 0; n < disputes.of_surface[s].size(); ++n) {
      const std::size_t d = disputes.of_surface[s][n];
      if (!(depth[s][n] > deepest[d])) continue;
      deepest[d] = depth[s][n];
      winner[d] = s;
    }
  }
  for (std::size_t d = 0; d < disputes.voxels.size(); ++d) {
    out.labels.voxels[disputes.voxels[d]] = labels[winner[d]];
    ++out.voxels[winner[d]];
  }
  return out;
}

}  // namespace pellicle
