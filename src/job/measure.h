#pragma once
/// Meshes of fitted surfaces and the figures that are measured on them.

#include <array>
#include <compare>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "pellicle/job/segment_options.h"
#include "pellicle/job/segmentation.h"

namespace pellicle {

/// Sample layouts by everything that they depend on, so that thousands of objects share a few. At most 64 are kept.
/// Threads may share it.
class MeshLayouts {
 public:
  /// As tessellate(), the layout made once.
  TriangleMesh mesh(const Surface& surface, int level);

 private:
  std::shared_ptr<const SampleLayout> layout(const SurfaceModel& model, int level);

  static constexpr std::size_t kMostLayouts = 64;
  std::mutex mutex_;
  std::map<LayoutKey, std::shared_ptr<const SampleLayout>> layouts_;
};

/// Fills mesh, topology, self-intersections, volume and area of each object, and the shape of many. Meshes of many
/// objects are coarser: facets of about a voxel, at most 4000 of them. A surface that intersects itself is not ok but
/// folded.
/// \param grid of the image: what lies outside is not visible.
/// \pre options.many: each object has a shape.
void measure(std::vector<ObjectResult>& objects, const ImageGrid& grid, const SegmentOptions& options);

/// All objects' meshes as one.
TriangleMesh merged_mesh(const std::vector<ObjectResult>& objects);

/// Mean extent of the objects along z over that in x and y: 1 for balls at the right spacing. Objects that the image
/// cuts off take no part. Not a number when none is left.
/// \pre each object has a shape.
double z_extent(const std::vector<ObjectResult>& objects);

}  // namespace pellicle
