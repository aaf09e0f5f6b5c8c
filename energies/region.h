#pragma once
/// region: two regions of different level, the likelihood that each voxel is on its right side.
///
/// Potential q(I) = clip(((a+b)/2 - I) / ((a-b)/2), -1, 1), a and b the levels inside and outside: the log-likelihood
/// ratio of two Gaussians of equal spread, scaled so that it is -1 well inside and +1 well outside, for any
/// intensity unit and either sign of contrast.
///
/// Least-squares form (line search, 1D Chan-Vese along each normal): t_i = argmin_t int_0^t q(P_i(s)) ds + 0.02 t^2/R,
/// -depth <= t <= R; P_i the profile of the smoothed image. Levels are re-estimated each step: globally by running
/// medians, and for each sample from bands of its own profile, shrunk to the global ones and averaged over neighbours,
/// which follows a bias field. Scalar form: E = h/A0 int_inside q dV in mm^2, through region_integral (divergence
/// theorem).

#include <limits>
#include <memory>

#include "pellicle/energies/profiles.h"
#include "pellicle/energies/rows.h"
#include "pellicle/energies/term.h"

namespace pellicle {

/// Targets of the line search. \param reach mm; profiles must cover [-reach, reach]. \param depth mm: no target lies
/// further inside.
NormalTargets region_targets(const Profiles& profiles, const Levels& levels, double reach,
                             double depth = std::numeric_limits<double>::infinity());

/// Levels re-estimated about the targets of the last search: inside from [-6,-1.5] h, outside from [1.5,5] h. With
/// `local`, per sample too. Returns false, and leaves `levels` alone, when the contrast fell below 0.3 of
/// `first_contrast` or changed sign.
bool update_levels(const Profiles& profiles, const NormalTargets& targets, const SampleGraph& graph, double h,
                   bool local, double first_contrast, Levels& levels);

/// q as an image, for the scalar form. \throws nothing; constant levels only.
Image<float> region_potential(const Image<float>& image, double inside, double outside);

/// Antiderivative Q of an image along its first index axis (cumulative trapezoid, mm): with e the world direction of
/// that axis, div(Q e) = q, so int_inside q dV = sum_i Q(x_i) e . a_i.
Image<float> antiderivative(const Image<float>& image);

/// Adds weight * h/A0 sum_i Q(x_i) e . a_i to the returned energy and its derivatives by x and by the area vectors.
double region_integral(const CubicField& antiderivative, const Vec3& axis_in_world, double scale,
                       const std::vector<Vec3>& x, const std::vector<Vec3>& area_vector, std::vector<Vec3>& dE_dx,
                       std::vector<Vec3>& dE_da);

/// The integral forms have no targets to take levels from: they are estimated from bands on both sides of the present
/// surface.
void estimate_levels(const StepView& step, Levels& levels);

/// Least-squares form: a search that is wide at first and narrows as the surface arrives; of membranes ridge_search
/// (energies/edge.h).
struct RegionTerm {
  TermOutput operator()(const StepView& step);

  double reach = 0.0;  ///< mm, of the next search
};

/// Scalar form. Its antiderivative image is kept as long as working image and levels stay the same.
struct RegionIntegralTerm {
  TermOutput operator()(const StepView& step);

  std::shared_ptr<const Image<float>> image = {};
  int version = -1;
  double inside = 0.0, outside = 0.0;
};

}  // namespace pellicle
