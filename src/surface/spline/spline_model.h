#pragma once
/// Tensor-product surfaces of interpolating exponential splines: sphere with smooth closed poles, torus, and the open
/// cylinder and rectangle. Source: Schmitter, Garcia-Amorena, Unser 2017, Eqs. (7), (11), (12), (14); signs and scales
/// as corrected in docs/models.md.
///
/// sigma(u, v) = sum_kl c[k,l] phi_1(M1 u - k) phi_2(M2 v - l), u, v in [0, 1]. Control points lie on the surface:
/// sigma(k/M1, l/M2) = c[k,l].

#include <string>
#include <utility>
#include <vector>

#include "pellicle/surface/parameters.h"
#include "pellicle/surface/samples.h"
#include "pellicle/surface/spline/spline_axis.h"

namespace pellicle {

enum class SplineTopology {
  sphere,     ///< u around (M1 >= 4), v from the north to the south pole (M2 >= 2, generator phi_{2 M2})
  torus,      ///< u around the major, v around the minor circle (M1, M2 >= 4)
  cylinder,   ///< open: u around (M1 >= 4), v along (M2 >= 1, Keys' generator)
  rectangle,  ///< open in both (M1, M2 >= 1, Keys' generator)
};
std::string to_string(SplineTopology topology);
std::string to_string(SplineGenerator generator);

struct SplineSettings {
  SplineTopology topology = SplineTopology::sphere;
  int m1 = 4, m2 = 2;
  SplineGenerator generator = SplineGenerator::exponential;  ///< of the closed directions and the sphere's meridians
  double reference_ratio = 0.4;                              ///< torus: minor over major radius of the reference shape
  bool operator==(const SplineSettings&) const = default;
};

struct SplinePoint {
  Vec3 x, x_u, x_v;  ///< position and derivatives by u and v in [0, 1]
};

struct BlockWeight {
  int block;
  double weight;
};

class SplineModel {
 public:
  /// \throws UsageError naming the size and its least value.
  explicit SplineModel(const SplineSettings& settings);

  const SplineSettings& settings() const { return settings_; }
  /// Sphere: north pole, south pole (points), T1N, T2N, T1S, T2S (vectors: sigma_v = T1 cos 2 pi u + T2 sin 2 pi u at
  /// the poles), then c[k,l], l = 1..M2-1, k fastest. Others: c[k,l], k fastest; open directions have M+3 rows,
  /// -1..M+1.
  std::vector<BlockKind> blocks() const;
  /// The exact unit sphere about the origin, or torus of major radius 1 and axis z; open shapes: cylinder of radius 1
  /// and square, both over [-1, 1]. With Keys' generator its interpolant.
  const Parameters& reference() const { return reference_; }
  /// On that shape itself, whatever the generator.
  Vec3 reference_point(double u, double v) const;
  int degrees_of_freedom() const { return static_cast<int>(reference_.size()); }
  int base_facets() const;
  /// Control points on the surface, without normals.
  TriangleMesh control_mesh(const Parameters& parameters) const;
  std::string name() const;  ///< "spline", "spline-torus", "spline-cylinder", "spline-rectangle"
  bool is_closed() const;

  const SplineAxis& along_u() const { return along_u_; }
  const SplineAxis& along_v() const { return along_v_; }
  /// c of these rows as a combination of blocks: itself, or what Eqs. (11), (12), (14) make of the poles.
  std::vector<BlockWeight> control(int row_u, int row_v) const;
  /// All c, row_u + along_u().rows() * row_v.
  std::vector<Vec3> control_grid(const Parameters& parameters) const;
  /// Adjoint of control_grid: adds to `gradient`.
  void pull_back_grid(const std::vector<Vec3>& dE_dc, std::vector<double>& gradient) const;

  /// \pre u and v in [0, 1].
  SplinePoint at(const Parameters& parameters, double u, double v) const;

  /// Sphere: directions of an icosphere, so that samples do not crowd at the poles. Others: 2^level intervals between
  /// control points. The samples of a level are among those of the next.
  SampleLayout layout(int level) const;
  /// Sphere: meridians and parallels through the control points, 2^level intervals between them: samples crowd at the
  /// poles as control points do, and no motion of these escapes. Others: as layout().
  SampleLayout knot_layout(int level) const;
  void evaluate(const Parameters& parameters, const SampleLayout& layout, bool with_jacobian,
                SurfaceSamples& samples) const;
  void pull_back(const Parameters& parameters, const SampleLayout& layout, const std::vector<Vec3>& dE_dx,
                 std::vector<double>& gradient) const;
  /// About 1.5 times as many control points each way (4, 6, 10, 16, 24, 36 ...), on the present surface, pole tangents
  /// and the slopes at open borders kept. Exact for ellipsoids (and elliptic tori); otherwise an interpolation whose
  /// error falls with the third power of the spacing of the control points (docs/models.md).
  std::pair<SplineModel, Parameters> refine(const Parameters& parameters) const;
  /// The same with numbers of control points of one's choice.
  /// \throws UsageError naming the size and its least value.
  std::pair<SplineModel, Parameters> resampled(const Parameters& parameters, int m1, int m2) const;
  /// How often a start model was refined to have about so many control points.
  int refinements() const;

 private:
  SplineSettings settings_;
  SplineAxis along_u_, along_v_;
  Parameters reference_;
};

/// The fewest control points that a fit starts with: sphere 4 x 2, torus 6 x 4, cylinder 4 x 1, rectangle 1 x 1.
SplineModel start_spline(SplineTopology topology);

/// The same sphere-like surface, parameterised anew so that its poles lie where `axis` (and its opposite) of the
/// reference sphere were: control points on the present surface there, pole tangents from its derivatives. Exact for
/// ellipsoids, otherwise as near as refine().
/// \throws UsageError for other topologies, or an axis of length zero.
Parameters place_poles(const SplineModel& model, const Parameters& parameters, const Vec3& axis);

}  // namespace pellicle
