#pragma once
/// Where a fit starts.

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "pellicle/image/image.h"
#include "pellicle/surface/surface.h"

namespace pellicle {

/// A ball in LPS mm.
struct SeedSphere {
  Vec3 center{0, 0, 0};
  double radius = 0.0;
};

/// A ball (sphere and automatic seeds), or a surface that is already near (mask and model seeds).
using Seed = std::variant<SeedSphere, Surface>;

/// Start surface from a mask: the moment ellipsoid of its largest component, then fitted to the mask's boundary with
/// `detail` refinements, so that the start is the mask up to the model's resolution.
/// \throws BadData when the mask is empty.
Surface surface_from_mask(const Image<std::uint8_t>& mask, SubdivisionRule rule, StartSolid solid, int detail);

/// Candidates for one object, best first, found without any hint: bright and dark blobs of every size
/// (scale space), components of Otsu thresholds, the centre. Judged by fitting (fit/hypotheses.h), not here.
/// Never empty for an image with contrast. Deterministic.
std::vector<SeedSphere> find_candidates(const Image<float>& image);

/// Start ball for the brain in a T1 head: BET's robust range, centre of gravity and half of the head's radius
/// (Smith 2002, Human Brain Mapping 17:143-155).
/// \throws BadData for an image without contrast.
SeedSphere find_head(const Image<float>& image);

}  // namespace pellicle
