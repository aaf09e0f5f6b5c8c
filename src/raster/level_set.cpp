#include "pellicle/raster/internal/level_set.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/MeshToVolume.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pellicle/base/parallel.h"

namespace pellicle {

namespace {

constexpr int kLeaf = 8;  // nodes along a leaf of FloatGrid

// What meshToVolume wants to see, in double and without a copy.
struct Facets {
  const NodeMesh& mesh;
  std::size_t polygonCount() const { return mesh.triangles.size(); }        // NOLINT(readability-identifier-naming)
  std::size_t pointCount() const { return mesh.vertices.size(); }           // NOLINT(readability-identifier-naming)
  std::size_t vertexCount(std::size_t /*polygon*/) const { return 3; }      // NOLINT(readability-identifier-naming)
  void getIndexSpacePoint(std::size_t n, std::size_t v, openvdb::Vec3d& x)  // NOLINT(readability-identifier-naming)
      const {
    const Vec3& p = mesh.vertices[static_cast<std::size_t>(mesh.triangles[n][v])];
    x = openvdb::Vec3d(p.x(), p.y(), p.z());
  }
};

// The nodes of one block are a leaf or all of one value.
LevelSet::Comparison compare_block(const openvdb::FloatGrid::ConstAccessor& access, const Index3& block,
                                   const Image<std::uint8_t>& mask) {
  const Index3& n = mask.grid.size;
  const int x0 = block[0] * kLeaf, y0 = block[1] * kLeaf, z0 = block[2] * kLeaf;
  const openvdb::Coord corner(x0, y0, z0);
  const auto* leaf = access.probeConstLeaf(corner);
  const float* values = leaf != nullptr ? leaf->buffer().data() : nullptr;
  const bool all_inside = leaf == nullptr && access.getValue(corner) < 0.0F;
  LevelSet::Comparison sum;
  for (int k = z0; k < std::min(z0 + kLeaf, n[2]); ++k) {
    for (int j = y0; j < std::min(y0 + kLeaf, n[1]); ++j) {
      const std::uint8_t* row = &mask.at(0, j, k);
      for (int i = x0; i < std::min(x0 + kLeaf, n[0]); ++i) {
        const bool inside =
            values != nullptr ? values[((i - x0) * kLeaf + (j - y0)) * kLeaf + (k - z0)] < 0.0F : all_inside;
        sum.inside += inside ? 1 : 0;
        sum.differ += inside != (row[i] != 0) ? 1 : 0;
      }
    }
  }
  return sum;
}

}  // namespace

double area_of(const NodeMesh& mesh) {
  double area = 0.0;
  for (const auto& t : mesh.triangles) {
    const Vec3& a = mesh.vertices[static_cast<std::size_t>(t[0])];
    const Vec3 ab = mesh.vertices[static_cast<std::size_t>(t[1])] - a;
    area += 0.5 * ab.cross(mesh.vertices[static_cast<std::size_t>(t[2])] - a).norm();
  }
  return area;
}

double node_count_estimate(const NodeMesh& mesh, double band) {
  constexpr double reach = 1e8;
  for (const Vec3& v : mesh.vertices) {
    if (!(v.cwiseAbs().maxCoeff() <= reach)) return std::numeric_limits<double>::infinity();
  }
  double edges = 0.0;  // also a needle without area has nodes
  for (const auto& t : mesh.triangles) {
    const Vec3& a = mesh.vertices[static_cast<std::size_t>(t[0])];
    edges += std::max((mesh.vertices[static_cast<std::size_t>(t[1])] - a).norm(),
                      (mesh.vertices[static_cast<std::size_t>(t[2])] - a).norm());
  }
  return (area_of(mesh) + 0.5 * edges) * (2.0 * band + 1.0);
}

struct LevelSet::Grid {
  openvdb::FloatGrid::Ptr values;
};

struct LevelSet::Reader::Access {
  openvdb::FloatGrid::ConstAccessor values;
};

LevelSet::LevelSet(const NodeMesh& mesh, double band, Wanted wanted) : grid_(new Grid) {
  openvdb::initialize();  // later calls do nothing
  const auto width = static_cast<float>(band);
  grid_->values = openvdb::tools::meshToVolume<openvdb::FloatGrid>(
      Facets{mesh}, *openvdb::math::Transform::createLinearTransform(1.0), width, width,
      wanted == Wanted::distances ? openvdb::tools::DISABLE_RENORMALIZATION : 0);
}

LevelSet::~LevelSet() = default;

LevelSet::Comparison LevelSet::compare(const Image<std::uint8_t>& mask) const {
  Index3 blocks{};
  for (std::size_t a = 0; a < 3; ++a) blocks[a] = (mask.grid.size[a] + kLeaf - 1) / kLeaf;
  std::vector<Comparison> layers(static_cast<std::size_t>(blocks[2]));
  parallel_for(layers.size(), 1, [&](std::size_t begin, std::size_t end) {
    const auto access = grid_->values->getConstAccessor();
    for (std::size_t k = begin; k < end; ++k) {
      for (int j = 0; j < blocks[1]; ++j) {
        for (int i = 0; i < blocks[0]; ++i) {
          const Comparison block = compare_block(access, {i, j, static_cast<int>(k)}, mask);
          layers[k].inside += block.inside;
          layers[k].differ += block.differ;
        }
      }
    }
  });
  Comparison sum;
  for (const Comparison& c : layers) {
    sum.inside += c.inside;
    sum.differ += c.differ;
  }
  return sum;
}

LevelSet::Reader::Reader(const LevelSet& level) : access_(new Access{level.grid_->values->getConstAccessor()}) {}

LevelSet::Reader::~Reader() = default;

double LevelSet::Reader::distance(const Vec3& x) {
  using Sampler = openvdb::tools::BoxSampler;
  constexpr float kDiagonal = 1.75F;  // of a cell, and a little
  const Vec3 low = x.array().floor();
  const openvdb::Coord cell(static_cast<int>(low.x()), static_cast<int>(low.y()), static_cast<int>(low.z()));
  float corner[2][2][2];
  Sampler::getValues(corner, access_->values, cell);
  const auto [least, most] = std::minmax_element(&corner[0][0][0], &corner[0][0][0] + 8);
  const float background = access_->values.tree().background();
  if (*most - *least > kDiagonal || *most >= background || *least <= -background)
    return std::numeric_limits<double>::quiet_NaN();
  const Vec3 f = x - low;
  return static_cast<double>(Sampler::trilinearInterpolation(corner, openvdb::Vec3R(f.x(), f.y(), f.z())));
}

}  // namespace pellicle
