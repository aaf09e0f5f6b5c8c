#pragma once
/// Which parts of a lattice the surface passes: everything else is wholly inside or outside.

#include <cstdint>
#include <vector>

#include "pellicle/image/image_grid.h"
#include "pellicle/mesh/triangle_mesh.h"
#include "pellicle/synthetic/shapes.h"

namespace pellicle {

/// A box of lattice points `first` ... `first + count - 1` of the lattice
/// x_in_index = (q + 0.5) / factor - 0.5 of `grid`: each voxel split into factor[0] x factor[1] x factor[2] equal
/// cells.
struct FineLattice {
  ImageGrid grid;
  Index3 factor{1, 1, 1};
  Index3 first{0, 0, 0};
  Index3 count{0, 0, 0};

  Vec3 world_of(int i, int j, int k) const {
    const Vec3 q(first[0] + i, first[1] + j, first[2] + k);
    const Vec3 f(factor[0], factor[1], factor[2]);
    return grid.world_from_index((q + Vec3::Constant(0.5)).cwiseQuotient(f) - Vec3::Constant(0.5));
  }
  /// Position of a world point in (i, j, k) of world_of.
  Vec3 local_of(const Vec3& x_in_world) const {
    const Vec3 f(factor[0], factor[1], factor[2]);
    const Vec3 q = (grid.index_from_world(x_in_world) + Vec3::Constant(0.5)).cwiseProduct(f) - Vec3::Constant(0.5);
    return q - Vec3(first[0], first[1], first[2]);
  }
  Vec3 step() const { return grid.spacing.cwiseQuotient(Vec3(factor[0], factor[1], factor[2])); }  ///< mm
};

/// Cubes of kEdge lattice points, each wholly inside, wholly outside, or cut.
class LatticeBlocks {
 public:
  static constexpr int kEdge = 4;
  enum class Kind : std::uint8_t { outside, inside, cut };

  /// \param margin_mm blocks within this distance of the surface count as cut too.
  LatticeBlocks(const FineLattice& lattice, const Body& body, const TriangleMesh& surface, double margin_mm);
  /// Of the block that holds lattice point (kEdge * bi, j, k).
  Kind kind(int bi, int j, int k) const { return kinds_[offset(bi, j / kEdge, k / kEdge)]; }
  int blocks_along_x() const { return blocks_[0]; }

 private:
  std::size_t offset(int bi, int bj, int bk) const {
    return static_cast<std::size_t>(bi) +
           static_cast<std::size_t>(blocks_[0]) *
               (static_cast<std::size_t>(bj) + static_cast<std::size_t>(blocks_[1]) * static_cast<std::size_t>(bk));
  }
  Index3 blocks_;
  std::vector<Kind> kinds_;
};

}  // namespace pellicle
