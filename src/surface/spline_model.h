#pragma once
/// Tensor-product surfaces of interpolating exponential splines: sphere with smooth closed poles, torus, and the open
/// cylinder and rectangle. Source: Schmitter, Garcia-Amorena, Unser 2017, Eqs. (7), (11), (12), (14); signs and scales
/// as corrected in docs/models.md.
///
/// sigma(u, v) = sum_kl c[k,l] phi_1(M1 u - k) phi_2(M2 v - l), u, v in [0, 1]. Control points lie on the surface:
/// sigma(k/M1, l/M2) = c[k,l].

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "pellicle/surface/parameters.h"
#include "pellicle/surface/samples.h"
#include "pellicle/surface/spline_generator.h"

namespace pellicle {

enum class SplineTopology {
  sphere,     ///< u around (M1 >= 4), v from the north to the south pole (M2 >= 2, generator phi_{2 M2})
  torus,      ///< u around the major, v around the minor circle (M1, M2 >= 4)
  cylinder,   ///< open: u around (M1 >= 4), v along (M2 >= 1); fit and export only
  rectangle,  ///< open in both; fit and export only
};
std::string to_string(SplineTopology topology);

struct SplineSettings {
  SplineTopology topology = SplineTopology::sphere;
  int m1 = 4, m2 = 2;
  SplineGenerator generator = SplineGenerator::exponential;
  double reference_ratio = 0.4;  ///< torus: minor over major radius of the reference shape
};

struct SplinePoint {
  Vec3 x, x_u, x_v;  ///< position and derivatives by u and v in [0, 1]
};

class SplineModel {
 public:
  /// \throws UsageError naming the size and its least value.
  explicit SplineModel(const SplineSettings& settings);

  const SplineSettings& settings() const { return settings_; }
  /// Sphere: north pole, south pole (points), T1N, T2N, T1S, T2S (vectors), then c[k,l], l = 1..M2-1, k fastest.
  /// Others: c[k,l], k fastest; open directions have M+3 rows, l = -1..M+1.
  std::vector<BlockKind> blocks() const;
  /// The exact unit sphere or torus (axis z) about the origin; open shapes: unit cylinder, unit square.
  const Parameters& reference() const { return reference_; }
  int degrees_of_freedom() const { return static_cast<int>(reference_.size()); }
  int base_facets() const;
  TriangleMesh control_mesh(const Parameters& parameters) const;
  std::string name() const;  ///< "spline", "spline-torus", "spline-cylinder", "spline-rectangle"
  bool is_closed() const;

  SplinePoint at(const Parameters& parameters, double u, double v) const;

  SampleLayout layout(int level) const;
  void evaluate(const Parameters& parameters, const SampleLayout& layout, bool with_jacobian,
                SurfaceSamples& samples) const;
  void pull_back(const Parameters& parameters, const SampleLayout& layout, const std::vector<Vec3>& dE_dx,
                 std::vector<double>& gradient) const;
  /// About 1.5 times as many control points each way (4, 6, 10, 16, 24, 36 ...), on the present surface, pole tangents
  /// kept. Exact for ellipsoids (and elliptic tori); otherwise an interpolation whose error falls with the third
  /// power of the spacing of the control points (docs/models.md).
  std::pair<SplineModel, Parameters> refine(const Parameters& parameters) const;
  /// How often a start model was refined to have about so many control points.
  int refinements() const;

 private:
  SplineSettings settings_;
  Generator along_u_, along_v_;
  Parameters reference_;
};

}  // namespace pellicle
