#pragma once
/// Given points that a surface should pass through, and the places of the surface nearest to them.

#include <vector>

#include "pellicle/base/geometry.h"

namespace pellicle {

/// Points that the surface should pass through (the energy springs). LPS mm.
struct ExpertPoints {
  std::vector<Vec3> points = {};
  std::vector<double> weights = {};  ///< one per point, >= 0; empty: 1 each
  bool held = false;                 ///< pull to the point itself; else along the normal only, the point may slide
  double weight(std::size_t k) const { return weights.empty() ? 1.0 : weights[k]; }
};

/// The place of the surface nearest to a data point.
struct Attachment {
  int triangle = -1;  ///< of the layout; -1: none
  Vec3 barycentric = Vec3::Zero();
  Vec3 lift = Vec3::Zero();    ///< mm, from the facet to the smooth surface
  Vec3 normal = Vec3::Zero();  ///< outward unit normal of the surface
  double offset = 0.0;         ///< n . (y - x), mm: positive where the data lie outside
  double distance = 0.0;       ///< |y - x|, mm
};

/// How far the expert points lie from the surface.
struct PointDistances {
  std::size_t count = 0;  ///< points with a weight
  double rms_mm = 0.0, max_mm = 0.0;
};

/// \param distances mm, one per point.
PointDistances summary_of(const ExpertPoints& points, const std::vector<double>& distances);

/// Springs of one step before they become rows, so that the fit can leave points out.
struct PointTargets {
  const ExpertPoints* points = nullptr;
  std::vector<Attachment> at = {};  ///< one per point
  std::vector<double> given = {};   ///< weight of each point as given; 0: left out
  std::vector<double> robust = {};  ///< the same, less where the point lies far off
  double sliding_fraction = 0.0;    ///< of the pull that acts along the surface
};

}  // namespace pellicle
