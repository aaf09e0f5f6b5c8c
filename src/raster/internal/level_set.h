#pragma once
/// OpenVDB's level set of a closed surface on the voxels of an image. OpenVDB's headers are included by level_set.cpp
/// only.

#include <memory>
#include <vector>

#include "pellicle/image/image.h"
#include "pellicle/mesh/triangle_mesh.h"

namespace pellicle {

/// A closed surface in the frame of its own nodes: coordinates are in units of the node distance.
struct NodeMesh {
  const std::vector<Vec3>& vertices;
  const std::vector<std::array<int, 3>>& triangles;
};

double area_of(const NodeMesh& mesh);

/// About how many nodes a level set of half width `band` (in node distances) takes; infinite when the surface is not
/// within reach of OpenVDB's integer coordinates. Time and memory are proportional to it, wherever the grid is.
double node_count_estimate(const NodeMesh& mesh, double band);
/// Beyond these, and one for each voxel of the image, a level set costs more than the image.
inline constexpr double kSpareNodes = 1e6;

/// OpenVDB's level set of a closed surface: signed distance at the nodes of a narrow band, the sign alone elsewhere.
class LevelSet {
 public:
  /// OpenVDB's renormalisation moves distances by up to 0.08 nodes but repairs most wrong signs (of a blob 55 voxels
  /// become 13, the farthest 0.23 voxels from the surface 0.03): for masks, not for distances.
  enum class Wanted { signs, distances };
  /// \param band half width in node distances, at least 1.
  /// \pre node_count_estimate(mesh, band) is bearable.
  LevelSet(const NodeMesh& mesh, double band, Wanted wanted);
  ~LevelSet();
  LevelSet(const LevelSet&) = delete;
  LevelSet& operator=(const LevelSet&) = delete;

  struct Comparison {
    std::size_t inside = 0;  ///< voxels that the level set has inside
    std::size_t differ = 0;  ///< voxels that it has on the other side than the mask
  };
  /// Against a mask whose voxels are the nodes. Visits only the part of the level set within the image.
  Comparison compare(const Image<std::uint8_t>& mask) const;

  /// Reads distances one after the other: fast where each point is near the one before. One per thread.
  class Reader {
   public:
    explicit Reader(const LevelSet& level);
    ~Reader();
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;
    /// Trilinear between nodes, in node distances. NaN where a node of the cell is beyond the band, or two of them
    /// differ by more than their distance: OpenVDB then has a sign wrong.
    double distance(const Vec3& x);

   private:
    struct Access;
    std::unique_ptr<Access> access_;
  };

 private:
  struct Grid;
  std::unique_ptr<Grid> grid_;
};

}  // namespace pellicle
