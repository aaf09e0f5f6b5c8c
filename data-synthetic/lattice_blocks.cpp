#include "pellicle/synthetic/internal/lattice_blocks.h"

#include <algorithm>
#include <cmath>

#include "pellicle/base/parallel.h"

namespace pellicle {

LatticeBlocks::LatticeBlocks(const FineLattice& lattice, const Body& body, const TriangleMesh& surface,
                             double margin_mm) {
  for (std::size_t a = 0; a < 3; ++a) blocks_[a] = (lattice.count[a] + kEdge - 1) / kEdge;
  kinds_.assign(offset(0, 0, blocks_[2]), Kind::outside);
  for (const auto& triangle : surface.triangles) {
    Vec3 low = Vec3::Constant(1e300), high = -low;
    double edge = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3& x = surface.vertices[static_cast<std::size_t>(triangle[c])];
      edge = std::max(edge, (x - surface.vertices[static_cast<std::size_t>(triangle[(c + 1) % 3])]).norm());
      const Vec3 p = lattice.local_of(x);
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    // Facets are flat: the surface bulges from them by far less than a fifth of their edge.
    const Vec3 pad = Vec3::Constant(1.0) + (Vec3::Constant(margin_mm + 0.2 * edge)).cwiseQuotient(lattice.step());
    Index3 from, to;
    for (int a = 0; a < 3; ++a) {
      const auto s = static_cast<std::size_t>(a);
      const double last = blocks_[s] - 1.0;
      from[s] = static_cast<int>(std::clamp(std::floor((low[a] - pad[a]) / kEdge), 0.0, last + 1.0));
      to[s] = static_cast<int>(std::clamp(std::floor((high[a] + pad[a]) / kEdge), -1.0, last));
    }
    for (int k = from[2]; k <= to[2]; ++k) {
      for (int j = from[1]; j <= to[1]; ++j) {
        for (int i = from[0]; i <= to[0]; ++i) kinds_[offset(i, j, k)] = Kind::cut;
      }
    }
  }
  parallel_for(static_cast<std::size_t>(blocks_[2]), 1, [&](std::size_t begin, std::size_t end) {
    for (int k = static_cast<int>(begin); k < static_cast<int>(end); ++k) {
      for (int j = 0; j < blocks_[1]; ++j) {
        for (int i = 0; i < blocks_[0]; ++i) {
          Kind& kind = kinds_[offset(i, j, k)];
          if (kind == Kind::cut) continue;
          const bool inside = body.level_at(lattice.world_of(kEdge * i, kEdge * j, kEdge * k)).value < 0.0;
          kind = inside ? Kind::inside : Kind::outside;
        }
      }
    }
  });
}

}  // namespace pellicle
