#pragma once
/// body: one small body among others of its kind; where along each normal it ends.
///
/// As `region` this is the two-level likelihood along each normal (1D Chan-Vese), in a form for objects of a few voxels
/// that touch: levels come from the whole body and from what little background each profile meets, and a profile ends
/// where the object's territory does.
///   t_i = argmax_t int_-w^t (P_i(s) - (a_i + b_i)/2) / (a_i - b_i) ds/w - pull (t/w)^2
/// a_i: half the median at 0.25, 0.45, 0.65, 0.8 of the way from the centroid to all samples (dark nucleoli do not move
/// a median), half the mean of the sample's own outer two. b_i: half the lower quartile of the own profile beyond
/// 0.15 r, half the median of those over the surface.
///
/// A step of level blurred by a Gaussian s passes the mean of its levels s^2/2 (k1 + k2) inside the true edge (Mendonca
/// et al. 2004; docs/energies.md), s^2/r on a ball. s is measured on the mean profile: the tails of a blurred step on
/// each side of the cut hold s / sqrt(2 pi) of the contrast.

#include <cstdint>
#include <vector>

#include "pellicle/energies/profiles.h"
#include "pellicle/energies/rows.h"
#include "pellicle/energies/term.h"

namespace pellicle {

struct BodySearch {
  double sign = 1.0;        ///< of inside - outside
  double half_width = 0.5;  ///< w, in the surface's rms radius r
  double pull = 0.075;      ///< keeps the nearer of two equal cuts
  double inward = 0.35;  ///< furthest way in, of the distance to the centroid: keeps bad starts from turning inside out
  double outward = 0.5;  ///< furthest way out, in r
  double least_radius = 0.0;                 ///< mm, r is not taken smaller
  double most_radius = 0.0;                  ///< mm from the centroid; 0: any
  bool unblur = false;                       ///< move the cut outward by the s^2 / r that a blur s takes from a ball
  const Image<float>* territory = nullptr;   ///< above 1/2 where the object may be; null: everywhere
  const std::vector<double>* cap = nullptr;  ///< mm from the centroid, one per sample; null: most_radius
};

/// What the image says at each sample.
struct BodyReading {
  NormalTargets targets;
  std::vector<double> drop;           ///< mean over 0.25 r inside the cut minus the same outside, intensity units
  std::vector<double> support;        ///< drop over the local contrast, 0..1
  std::vector<std::uint8_t> limited;  ///< the territory ends within 0.25 r beyond the cut
  std::vector<std::uint8_t> outside;  ///< of the image
  std::vector<double> reach;          ///< mm from the centroid to the sample
  Vec3 centroid{0, 0, 0};             ///< of the surface, LPS mm
  double radius = 0.0;                ///< r, mm
  double blur = 0.0;                  ///< s of the image across the surface, mm, at most r / 4
  double inside = 0.0, beyond = 0.0;  ///< median levels, intensity units
};

BodyReading read_body(const TrilinearField& image, const SampleView& surface, const BodySearch& search);

/// A wide search first, ever narrower ones later: half widths 0.6 to 0.35 of the radius. Where a typical object is
/// known, a twentieth of the weight draws the surface towards its shape.
struct BodyTerm {
  TermOutput operator()(const StepView& step) const;
};

}  // namespace pellicle
