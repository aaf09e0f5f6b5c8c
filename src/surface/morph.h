#pragma once
/// Shapes between two surfaces of one kind, and beyond them: least-energy paths in the Hilbert plane and on the Hilbert
/// sphere. Source: Schmitter, Garcia-Amorena, Unser 2017, section 6.3.1, Eqs. (15)-(19). tau = 0 is A and tau = 1 is B
/// in both spaces (the paper's Eq. (17) runs the other way); other values extrapolate.
///
/// Plane: control points and vectors are linear in tau, p = (1 - tau) p_A + tau p_B.
/// Sphere: each shape is split into its mean m, its size |s - m| and the normalised shape (s - m)/|s - m|, a point of
/// the unit sphere of shapes. The normalised shapes follow the great circle, Eq. (19); m is linear and the size
/// geometric in tau, s_A^(1-tau) s_B^tau. So the path does not depend on where the shapes lie (Eq. (19) as printed
/// does), and ends at A and B themselves.
/// Unit normals of control points turn along the great circle between them in both spaces.
///
/// The inner product of two shapes is the mean of a . b: for splines over the parameters u and v, Eq. (16), exactly;
/// for the other models over the reference shape by area, at samples. The normal model, which is not linear in its
/// parameters, leaves the great circle a little; its mean and size are still exact.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "pellicle/surface/surface.h"

namespace pellicle {

enum class MorphSpace { plane, sphere };

/// How shapes of one model are compared: by samples, or (splines) by the Gram matrix of the blocks; the other is empty.
struct ShapeMeasure {
  SampleLayout layout;
  std::vector<double> weights;  ///< of the samples, sum 1
  Eigen::MatrixXd gram;
};

/// First and second moments of two shapes under a measure.
struct ShapeMoments {
  Vec3 mean_a{0, 0, 0}, mean_b{0, 0, 0};  ///< mm
  double size_a = 0.0, size_b = 0.0;      ///< |a - mean_a|, mm: root mean square over the shape
  double angle = 0.0;                     ///< between (a - mean_a)/size_a and that of b, [0, pi]
};

/// Everything that the shapes of one path have in common.
struct MorphPath {
  MorphSpace space = MorphSpace::plane;
  SurfaceModel model;  ///< of every shape
  Parameters a, b;     ///< on that model
  ShapeMeasure measure;
  ShapeMoments moments;
};

/// Two surfaces with one control mesh.
struct MatchedSurfaces {
  Surface a, b;
  bool a_changed = false, b_changed = false;  ///< has more control points than before
};

/// Brings both surfaces to one control mesh: splines to the larger M1 and M2, of the others the coarser one is refined
/// until it has the other's.
/// \throws UsageError when they are of different kinds, rules, generators or control meshes.
MatchedSurfaces match_surfaces(const Surface& a, const Surface& b);

/// Where the models have no reference shape, areas are those of the two shapes.
ShapeMeasure shape_measure(const MatchedSurfaces& surfaces);
ShapeMoments shape_moments(const SurfaceModel& model, const ShapeMeasure& measure, const Parameters& a,
                           const Parameters& b);

/// \throws BadData when a shape is a single point, or the two are opposite points of the Hilbert sphere.
MorphPath morph_path(const MatchedSurfaces& surfaces, MorphSpace space);

/// The shape at `tau`; the very parameters of A and B at 0 and 1.
Surface surface_at(const MorphPath& path, double tau);

}  // namespace pellicle
