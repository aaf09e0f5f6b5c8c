#pragma once
/// Distances between surfaces, mm, weighted by area.

#include <memory>
#include <vector>

#include "pellicle/mesh/triangle_mesh.h"

namespace pellicle {

/// Nearest points on a fixed mesh (Embree point queries). Owns its acceleration structure; queries are thread-safe.
class ClosestPoint {
 public:
  /// \throws BadData when a facet names a vertex that does not exist or a coordinate is not finite.
  explicit ClosestPoint(const TriangleMesh& mesh);
  ~ClosestPoint();
  ClosestPoint(const ClosestPoint&) = delete;
  ClosestPoint& operator=(const ClosestPoint&) = delete;

  struct Hit {
    Vec3 point;  ///< on the mesh
    int triangle = -1;
    double distance;  ///< unsigned, mm
  };
  /// Exact to rounding in double, wherever the mesh lies. Of equally near facets the lowest index is named. A mesh
  /// without facets gives triangle -1 and an infinite distance.
  Hit query(const Vec3& x) const;
  /// The same where a point lies within `within_mm`, else triangle -1 and an infinite distance. Much faster when tight.
  Hit query(const Vec3& x, double within_mm) const;
  /// Whether `query(x, within_mm)` finds a facet. Much faster where many facets are near.
  bool is_within(const Vec3& x, double within_mm) const;

 private:
  struct Scene;
  std::unique_ptr<Scene> scene_;
};

/// `count` points spread evenly by area; the same mesh gives the same points. Empty when the mesh has no area.
std::vector<Vec3> sample_surface(const TriangleMesh& mesh, int count);

/// Symmetric distances: both surfaces are sampled evenly (`samples` points each, area-weighted).
struct SurfaceDistances {
  double assd = 0.0;  ///< average symmetric surface distance: mean over both sample sets together, by area
  double hd95 = 0.0;  ///< larger of the two directed 95th percentiles
  double hd = 0.0;    ///< larger of the two directed maxima, over samples and vertices
  double nsd = 0.0;   ///< normalised surface Dice: fraction of both areas within the tolerance of the other
};
/// Swapping a and b gives the same bits.
/// \throws BadData when a surface has no area.
SurfaceDistances surface_distances(const TriangleMesh& a, const TriangleMesh& b, double tolerance_mm,
                                   int samples = 20000);

}  // namespace pellicle
