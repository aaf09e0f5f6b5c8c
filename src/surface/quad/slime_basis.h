#pragma once
/// Patches of generalised biquadratic B-splines: S-patches of depth 5 over the regular n-gon, as weights of the 2n + 1
/// points of the Sabin net about a vertex of valence n. Source: Stoddart, Hilton, Illingworth 1994 ("slime"); S-patches
/// and the panels along the borders Loop, DeRose 1989, 1990; interior points as in docs/any-topology.md.
///
/// Sabin net: the vertex v, edge midpoints e_i = (v + a_i)/2, quad centroids f_i = (v + a_i + b_i + a_{i+1})/4, in this
/// order (v, e_0 .., f_0 ..), counter-clockwise. Domain: unit edges, centred at the origin, corner i at angle 2 pi i/n.
/// Corner i is f_i; the side from corner i to i + 1 passes through e_{i+1}. For n = 4 the patch is the biquadratic.

#include <Eigen/Dense>
#include <vector>

namespace pellicle {

/// Row p holds the weights of the net's points at domain point p; derivatives by the domain's coordinates.
struct SlimeWeights {
  Eigen::MatrixXd x, u, v;
  Eigen::MatrixXd uu, uv, vv;  ///< on request
};

class SlimeBasis {
 public:
  static constexpr int highest_valence = 12;
  /// \throws BadData unless the valence is in 3 .. highest_valence.
  explicit SlimeBasis(int valence);

  int valence() const { return valence_; }
  Eigen::Vector2d corner(int i) const;
  SlimeWeights at(const std::vector<Eigen::Vector2d>& points, bool second_derivatives = false) const;
  /// int |S_uu|^2 + 2 |S_uv|^2 + |S_vv|^2 over the n-gon as a quadratic form of the net's points (Gauss points on n
  /// triangles, converged to rounding). Its null space are the translations; for n = 4 the linear functions, too.
  Eigen::MatrixXd stiffness() const;

 private:
  int valence_;
  std::vector<std::vector<int>> labels_;  ///< exponents of the Bezier points, sum 5
  std::vector<double> multinomial_;
  Eigen::MatrixXd control_;  ///< Bezier points as combinations of the net
};

}  // namespace pellicle
