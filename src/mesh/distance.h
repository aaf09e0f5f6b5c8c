#pragma once
/// Distances between surfaces, mm, weighted by area.

#include <optional>

#include "pellicle/mesh/triangle_mesh.h"

namespace pellicle {

/// Nearest points on a fixed mesh (Embree point queries). Owns its acceleration structure; queries are thread-safe.
class ClosestPoint {
 public:
  explicit ClosestPoint(const TriangleMesh& mesh);
  ~ClosestPoint();
  ClosestPoint(const ClosestPoint&) = delete;
  ClosestPoint& operator=(const ClosestPoint&) = delete;

  struct Hit {
    Vec3 point;       ///< on the mesh
    int triangle = -1;
    double distance;  ///< unsigned, mm
  };
  Hit query(const Vec3& x) const;

 private:
  struct Scene;
  Scene* scene_;
};

/// Symmetric distances: both surfaces are sampled evenly (about `samples` points each, area-weighted).
struct SurfaceDistances {
  double assd = 0.0;  ///< average symmetric surface distance: mean over both sample sets together, by area
  double hd95 = 0.0;  ///< larger of the two directed 95th percentiles
  double hd = 0.0;    ///< larger of the two directed maxima
  double nsd = 0.0;   ///< normalised surface Dice: share of both areas within the tolerance of the other
};
SurfaceDistances surface_distances(const TriangleMesh& a, const TriangleMesh& b, double tolerance_mm,
                                   int samples = 20000);

}  // namespace pellicle
