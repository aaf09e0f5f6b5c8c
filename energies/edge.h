#pragma once
/// edge: the sub-voxel position of the boundary along each normal, robust.
///
/// Step edge (volume-conserving localiser): f = clip((P - b)/(a - b), -1/2, 3/2) on the unsmoothed image, a and b the
/// local levels; t = int_{-w}^{w} f ds - w. Any symmetric point spread leaves the integral alone. Ridge (membrane):
/// t = centroid of the profile above its two sides.
/// Both lie s^2 (k1+k2)/2 inside the true surface when the image is blurred by s (first order in curvature; on a
/// sphere s^2/R), which is added back; curvature is held fixed after the first steps, or it would be an anti-diffusion.
/// Weights: contrast below the median counts less, below a quarter of it not at all; Cauchy weights for outliers.

#include "pellicle/energies/profiles.h"
#include "pellicle/energies/rows.h"
#include "pellicle/energies/term.h"

namespace pellicle {

struct EdgeSettings {
  double h = 1.0;       ///< mm
  double window = 2.5;  ///< half width of the localiser, in h
  bool ridge = false;
  int sign = 0;  ///< sign of inside - outside (of ridge - sides) to be believed; 0: either
};

struct EdgeMeasurement {
  NormalTargets targets;
  std::vector<double> inside, outside;  ///< local levels (ridge: top and sides)
  double median_contrast = 0.0;
  double blur = 0.0;  ///< s in mm, from the mean profile's width, 0 when it cannot be measured
};

/// \pre profiles of the unsmoothed image cover [-4h, 4h] (ridge: [-8h, 8h]).
EdgeMeasurement measure_edge(const Profiles& profiles, const SampleGraph& graph, const EdgeSettings& settings);

/// Long-range form for membranes: the nearest local maximum, within `reach` mm, of the height above both sides (3 h
/// away) that is at least half of what is typical over the surface; samples that see none get little weight.
NormalTargets ridge_search(const Profiles& profiles, double sign, double reach, double h);

/// s^2 (k1+k2)/2 for each sample, mm; |k1+k2| is limited to a quarter per h.
std::vector<double> curvature_correction(const std::vector<double>& curvature, double blur, double h);

/// Finds the edge anew in each step, in a window that narrows to 1.75 h; measures blur and curvature in the first ones.
struct EdgeTerm {
  TermOutput operator()(const StepView& step);

  double window = 2.5;                 ///< h
  std::vector<double> curvature = {};  ///< k1 + k2 at each sample, 1/mm, averaged over neighbours
};

}  // namespace pellicle
