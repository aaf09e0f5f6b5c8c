#pragma once
/// Exact shapes as implicit functions: negative inside, smooth near the surface, with analytic gradients. Only the
/// function, its gradient, a bounding box and the volume are needed, so a shape of any genus is one more entry here.
/// Shape frame: mm, the shape's own axes, its reference point at the origin.

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "pellicle/base/geometry.h"

namespace pellicle {

/// Value and gradient of an implicit function; value / |gradient| is the signed distance to first order.
struct LevelSample {
  double value = 0.0;
  Vec3 gradient = Vec3::Zero();
};

/// |x / half_axes| - 1.
struct EllipsoidShape {
  Vec3 half_axes;
};
/// ((|x/a|^4 + |y/b|^4)^(3/4) + |z/c|^3)^(1/3) - 1: between ellipsoid and box, C2.
struct SuperquadricShape {
  Vec3 half_axes;
};
/// |x| - R (1 + sum_i c_i P_li(v_i . x/|x|)): zonal harmonics of degree 2 to 5 about random axes, which together are
/// a random real spherical harmonic; the largest |sum| over the sphere is the amplitude.
struct BlobShape {
  struct Term {
    int degree;
    Vec3 axis;
    double coefficient;
  };
  double radius;
  double peak;  ///< bound of 1 + sum
  std::vector<Term> terms;
};
/// An ellipsoid bent by y -> y + b (x^2/a_x^2 - 1/5), b = a_y: a kidney with a dent on its +y side. The map keeps
/// volumes, and the centroid stays at the origin.
struct BeanShape {
  Vec3 half_axes;
};
/// Balls of radius a at (+-c,0,0), joined by -k log(exp(-d1/k) + exp(-d2/k)): a smooth union with a neck.
struct DumbbellShape {
  double ball_radius, ball_offset, blend;
};
/// A capsule bent along a circular arc: all points within `radius` of the arc of `arc_radius` that spans
/// +-half_angle about +x in the plane z = 0. The origin is the arc's centroid.
struct TubeShape {
  double radius, arc_radius, half_angle;
};

/// All points within `minor` of the circle of radius `major` about the z axis. Genus 1.
struct TorusShape {
  double major, minor;
};
/// Two such tori about the axes x = +-major, whose centre circles touch at the origin, joined as the dumbbell's balls
/// are. Genus 2.
struct DoubleTorusShape {
  double major, minor, blend;
};

using Shape = std::variant<EllipsoidShape, SuperquadricShape, BlobShape, BeanShape, DumbbellShape, TubeShape,
                           TorusShape, DoubleTorusShape>;

/// Names that make_shape knows, in the order of the help text.
const std::vector<std::string>& shape_names();
/// True for shapes that take three half axes besides one scale.
bool shape_has_half_axes(const std::string& name);
/// Holes through the shape: 0, torus 1, double-torus 2.
int shape_genus(const std::string& name);

/// \param radius one value R: sphere of radius R, ellipsoid R (1, 1.3, 0.75), superquadric R (1, 1.15, 0.85), bean
///        R (1.45, 0.85, 0.8), blob of mean radius R, dumbbell of two balls 0.8 R at +-0.9 R, tube of thickness 0.5 R
///        along an arc of radius 1.1 R, torus R (1, 0.4), double torus R (0.7, 0.3); three values: the half axes, where
///        the shape has them; two: MAJOR and MINOR radius of a torus, of each of the two.
/// \param amplitude,seed of the blob: its largest relative deviation from the sphere, and what draws it.
/// \throws UsageError for an unknown name or a radius that does not fit the shape.
Shape make_shape(const std::string& name, const std::vector<double>& radius, double amplitude, std::uint64_t seed);

LevelSample level(const Shape& shape, const Vec3& x);

/// A box that holds the shape, as half edges about the origin, mm.
Vec3 half_bounds(const Shape& shape);

/// mm^3. Closed form (sphere, ellipsoid, superquadric, bean, tube, torus), or a quadrature that has converged to better
/// than 1e-9 relative (blob, dumbbell, double torus).
double exact_volume(const Shape& shape);

/// A shape placed in the world: x_in_world = center + world_from_shape * x_in_shape, a rotation.
struct Body {
  Shape shape = EllipsoidShape{Vec3::Ones()};
  Mat3 world_from_shape = Mat3::Identity();
  Vec3 center{0, 0, 0};

  /// Value and world gradient at a world point.
  LevelSample level_at(const Vec3& x_in_world) const {
    LevelSample s = level(shape, world_from_shape.transpose() * (x_in_world - center));
    s.gradient = world_from_shape * s.gradient;
    return s;
  }
  /// First-order signed distance, mm; accurate near the surface only.
  double distance_near(const Vec3& x_in_world) const;
  /// The surface point near `x`: exact up to rounding where `x` is within the smallest radius of curvature.
  Vec3 closest_point_near(const Vec3& x_in_world) const;
};

}  // namespace pellicle
