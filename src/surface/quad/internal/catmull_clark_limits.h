#pragma once
/// Points and derivatives of Catmull-Clark limit surfaces as constant weights, by OpenSubdiv in double precision.

#include <memory>
#include <vector>

#include "pellicle/mesh/quad/quad_mesh.h"

namespace pellicle {

/// A place on a quad: s from corner 0 to 1, t from corner 0 to 3, in [0, 1].
struct QuadPlace {
  int quad = 0;
  double s = 0.0, t = 0.0;
};

/// Row r holds the weights over control points of the r-th place: position and derivatives by s and t.
struct LimitWeights {
  std::vector<int> start{0}, index;
  std::vector<double> x, s, t, ss, st, tt;
};

/// A piece of a quad that is one polynomial (bicubic) patch: [s, s + width] x [t, t + width].
struct QuadPiece {
  int quad = 0;
  double s = 0.0, t = 0.0, width = 1.0;
};

/// What closes the hole that is left about an extraordinary vertex after so many levels of isolation.
enum class LimitCap {
  gregory,  ///< exact position and tangent plane at the vertex itself
  bspline,  ///< bicubic: second derivatives are bounded
};

class CatmullClarkLimits {
 public:
  /// \param isolation levels of subdivision towards extraordinary vertices, 1 to 10; exact wherever a place is
  /// separated from them by so many levels.
  CatmullClarkLimits(const QuadTopology& topology, int isolation, LimitCap cap);
  ~CatmullClarkLimits();
  CatmullClarkLimits(const CatmullClarkLimits&) = delete;
  CatmullClarkLimits& operator=(const CatmullClarkLimits&) = delete;

  /// At an extraordinary vertex itself the derivatives have no meaningful length. Second derivatives on request.
  LimitWeights at(const std::vector<QuadPlace>& places, bool second_derivatives = false) const;
  std::vector<QuadPiece> pieces() const;

 private:
  struct Tables;
  std::unique_ptr<Tables> tables_;
};

}  // namespace pellicle
