#pragma once
/// A closed genus-0 surface laid out on the unit sphere, one to one, limbs included.
///
/// Source: Praun, Hoppe 2003, "Spherical parametrization and remeshing": the mesh is collapsed to a tetrahedron, which
/// is put on the sphere; vertices come back one by one into the kernel of their ring, and after each doubling or so
/// all are moved, one at a time, to lessen the L2 stretch of the map from the sphere to the surface,
///   E = sum_T A_T (s1^2 + s2^2)/2 (1 + 2 s^4/(s1 s2)^2),   s1, s2 the singular values of the linear map from the
/// spherical triangle to T, s^2 the surface's area over 4 pi: stretch both ways (the inverse keeps the map smooth),
/// which is infinite where a triangle would fold and least where every part of the surface gets its fraction of
/// the sphere. The steps are Newton's in the tangent plane of one vertex, with a line search that refuses folds.

#include <vector>

#include "pellicle/base/observer.h"
#include "pellicle/mesh/triangle_mesh.h"

namespace pellicle {

struct SphereMapSettings {
  int max_vertices = 6000;  ///< the surface is simplified to so many (its vertices stay on the surface)
  int sweeps = 12;          ///< over all vertices at each density
  /// Parts of inner radius r get a part of the sphere that grows as (R/r)^fairness, R the median of r: 0 treats all
  /// parts the same, 2 gives thin limbs as many control points around as thick ones.
  double fairness = 0.0;
};

/// The (simplified) surface and where its vertices lie on the unit sphere, whose z axis is the object's longest.
struct SphereMap {
  TriangleMesh mesh;            ///< LPS mm
  std::vector<Vec3> direction;  ///< unit vectors; det(d0, d1, d2) > 0 for every triangle
  double stretch = 0.0;         ///< E over what an isometry up to scale would have: 1 at best
};

/// \throws BadData unless `mesh` is closed, manifold, oriented, outward, connected and of genus 0.
SphereMap map_to_sphere(const TriangleMesh& mesh, const SphereMapSettings& settings = {},
                        const Observer& observer = {});

/// Radius of the largest ball inside the surface that touches it at each vertex, mm, by shrinking (Ma, Bae, Choi 2012);
/// averaged over neighbours, since the ball at a sharp edge is empty.
/// \pre `mesh` is closed and outward.
std::vector<double> inner_radii(const TriangleMesh& mesh);

/// Signed area of the spherical triangle of three unit vectors (Van Oosterom, Strackee 1983).
double spherical_area(const Vec3& a, const Vec3& b, const Vec3& c);

/// Finds points of the surface by their direction. Holds a reference to the map.
class SphereLocator {
 public:
  explicit SphereLocator(const SphereMap& map);
  struct Place {
    int triangle = -1;
    Vec3 barycentric = Vec3::Zero();
  };
  /// \param direction not zero.
  /// \param hint a triangle near it, -1: none.
  Place locate(const Vec3& direction, int hint = -1) const;
  Vec3 point_at(const Place& place) const;

 private:
  const SphereMap& map_;
  std::vector<std::array<int, 3>> across_;  ///< neighbour over the edge that starts at each corner
};

}  // namespace pellicle
