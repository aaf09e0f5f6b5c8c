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

/// Candidates for one object, found without any hint: the deepest points of the two largest bright and dark parts (Otsu
/// threshold of the volume at 64 voxels along its longest axis), and the centre. Judged by fitting (fit/fit.h), not
/// here. Never empty for an image with contrast. Deterministic.
std::vector<SeedSphere> find_candidates(const Image<float>& image);

/// Start ball for the brain in a T1 head: BET's robust range, centre of gravity and half of the head's radius
/// (Smith 2002, Human Brain Mapping 17:143-155).
/// \throws BadData for an image without contrast.
SeedSphere find_head(const Image<float>& image);

}  // namespace pellicle
